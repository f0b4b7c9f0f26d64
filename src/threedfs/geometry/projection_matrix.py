"""Cameras from projection matrices."""

from __future__ import annotations

import numpy as np
from scipy.linalg import rq

from threedfs.geometry.rigid import make_transform


def decompose_projection(projection: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split a projection matrix (3, 4) into intrinsics and pose.

    The sign of a projection is free: the one is taken that makes the pose a rotation without reflection.

    Parameters
    ----------
    projection : (3, 4) float64
        Homogeneous pixel = projection @ homogeneous world point.

    Returns
    -------
    intrinsics : (3, 3) float64
        Upper triangular with positive diagonal, lower right 1.
    cam_from_world : (4, 4) float64

    Raises
    ------
    ValueError
        If the left 3x3 block is singular or not finite.

    Examples
    --------
    >>> intrinsics, cam_from_world = decompose_projection(-np.eye(3, 4))
    >>> bool(np.allclose(intrinsics, np.eye(3)) and np.allclose(cam_from_world, np.eye(4)))
    True
    """
    if not np.all(np.isfinite(projection)):
        raise ValueError("numbers that are not finite")
    determinant = np.linalg.det(projection[:, :3])
    if abs(determinant) <= 1e-12 * np.abs(projection[:, :3]).max() ** 3:
        raise ValueError("a singular matrix")
    projection = projection * np.sign(determinant)
    intrinsics, rotation = rq(projection[:, :3])
    signs = np.diag(np.sign(np.diag(intrinsics)))
    intrinsics, rotation = intrinsics @ signs, signs @ rotation
    translation = np.linalg.solve(intrinsics, projection[:, 3])
    return intrinsics / intrinsics[2, 2], make_transform(rotation, translation)
