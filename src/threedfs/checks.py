"""Validation of arrays that explains what is wrong."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError


def check_shape(array: np.ndarray, expected: tuple[int | None, ...], what: str) -> np.ndarray:
    """Return `array` if its shape matches, with None as a wildcard.

    Parameters
    ----------
    array : ndarray
    expected : tuple of int or None
    what : str
        Name of the array in the message, e.g. ``"depth of keyframe 000030"``.

    Raises
    ------
    UserError
        If the number of axes or a length differs.

    Examples
    --------
    >>> check_shape(np.zeros((4, 3)), (None, 3), "points").shape
    (4, 3)
    """
    matches = array.ndim == len(expected) and all(
        want is None or want == have for want, have in zip(expected, array.shape, strict=True)
    )
    if not matches:
        wanted = "(" + ", ".join("any" if n is None else str(n) for n in expected) + ")"
        raise UserError(f"{what}: expected shape {wanted}, got {array.shape}; images are (row, column).")
    return array


def check_transform(matrix: np.ndarray, what: str, tolerance: float = 1e-5) -> np.ndarray:
    """Return `matrix` as float64 if it is a rigid 4x4 transform.

    Parameters
    ----------
    matrix : ndarray
    what : str
        Name of the matrix in the message.
    tolerance : float
        How far products of the rotation's rows may be from those of unit vectors at right angles.

    Raises
    ------
    UserError
        If it is not 4x4, not finite, its last row is not (0, 0, 0, 1), or its upper left block is no rotation.
    """
    matrix = check_shape(np.asarray(matrix, dtype=np.float64), (4, 4), what)
    if not np.all(np.isfinite(matrix)):
        raise UserError(f"{what}: expected finite numbers, got NaN or infinity.")
    if not np.allclose(matrix[3], (0, 0, 0, 1), atol=1e-9):
        raise UserError(f"{what}: expected the last row (0, 0, 0, 1), got {matrix[3]}; is it transposed?")
    rotation = matrix[:3, :3]
    if not np.allclose(rotation @ rotation.T, np.eye(3), atol=tolerance) or np.linalg.det(rotation) < 0:
        raise UserError(
            f"{what}: expected a rotation in the upper left 3x3 block, got determinant "
            f"{np.linalg.det(rotation):.4g}; it probably carries a scale or a reflection."
        )
    return matrix
