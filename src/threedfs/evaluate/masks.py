"""Agreement of masks."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError


def intersection_over_union(mask: np.ndarray, truth: np.ndarray, what: str = "mask") -> float:
    """Return the intersection over union of two masks (H, W) bool; two empty masks agree fully.

    Parameters
    ----------
    mask, truth : (H, W) bool
    what : str
        Name of the true mask in the message.

    Raises
    ------
    UserError
        If their sizes differ.

    References
    ----------
    Section 4.3: the paper's measure of segmentation.

    Examples
    --------
    >>> intersection_over_union(np.array([[True, True, False]]), np.array([[False, True, True]]))
    0.3333333333333333
    """
    check_mask_size(truth, mask.shape, what)
    union = int(np.count_nonzero(mask | truth))
    return int(np.count_nonzero(mask & truth)) / union if union else 1.0


def check_mask_size(mask: np.ndarray, shape: tuple[int, int], what: str) -> None:
    """Raise a UserError unless a mask has the shape (rows, columns) of the source frames."""
    if tuple(mask.shape) != tuple(shape):
        raise UserError(
            f"{what}: expected a mask of {shape[1]} x {shape[0]} pixels (width x height) like the source frames, got "
            f"{mask.shape[1]} x {mask.shape[0]}; save masks at the resolution and orientation of the video or photos."
        )
