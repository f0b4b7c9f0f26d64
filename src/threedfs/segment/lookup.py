"""Which pixel of a view shows a world point."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.projection import project
from threedfs.types import View


def find_pixels(view: View, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pixels nearest to the projections of world points (N, 3).

    Returns
    -------
    row, column : (M,) int64
        Of the points that the image shows.
    kept : (N,) bool
        Which points those are.
    """
    pixels, _ = project(view, points)
    column, row = (np.rint(np.nan_to_num(pixels[:, axis], nan=-1)).astype(np.int64) for axis in (0, 1))
    kept = (column >= 0) & (column < view.camera.width) & (row >= 0) & (row < view.camera.height)
    return row[kept], column[kept], kept
