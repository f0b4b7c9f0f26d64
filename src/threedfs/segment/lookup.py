"""Which pixel of a view shows a world point."""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.types import View


def find_pixels(view: View, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the pixels nearest to the projections of world points (N, 3) float64.

    Returns
    -------
    row, column : (M,) int32
        Of the points that the image shows.
    kept : (N,) bool
        Which points those are.
    """
    row, column = nearest_pixels(view, points)
    kept = row >= 0
    return row[kept], column[kept], kept


def nearest_pixels(view: View, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return row and column (N,) int32 of the pixels nearest to world points (N, 3) float64, -1 where there is none."""
    return _find(np.ascontiguousarray(points), view.px_from_world, view.camera.height, view.camera.width)


@njit(nogil=True, cache=True)
def _find(points, px_from_world, height, width):
    """Return row and column (N,) int32 of the nearest pixels, -1 outside the image and behind the camera."""
    row, column = np.empty(len(points), np.int32), np.empty(len(points), np.int32)
    for n in range(len(points)):
        row[n], column[n] = find_pixel(points[n, 0], points[n, 1], points[n, 2], px_from_world, height, width)
    return row, column


@njit(nogil=True, cache=True)
def find_pixel(x, y, z, px_from_world, height, width):
    """Return row and column of the pixel nearest to a world point, -1 outside the image and behind the camera."""
    m = px_from_world
    depth = m[2, 0] * x + m[2, 1] * y + m[2, 2] * z + m[2, 3]
    if depth > 0:
        u = np.rint((m[0, 0] * x + m[0, 1] * y + m[0, 2] * z + m[0, 3]) / depth)
        v = np.rint((m[1, 0] * x + m[1, 1] * y + m[1, 2] * z + m[1, 3]) / depth)
        if 0 <= u < width and 0 <= v < height:
            return int(v), int(u)
    return -1, -1
