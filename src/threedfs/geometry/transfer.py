"""Pixels of one view, at their depths, as pixels of another."""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.types import View


def px_from_px(target: View, source: View) -> np.ndarray:
    """Return the (3, 4) map from depth * (u, v, 1) of the source, and 1, to homogeneous pixels of the target."""
    rotation = target.cam_from_world[:3, :3] @ source.cam_from_world[:3, :3].T
    translation = target.cam_from_world[:3, 3] - rotation @ source.cam_from_world[:3, 3]
    cam_from_px = np.linalg.inv(source.camera.px_from_cam)
    return target.camera.px_from_cam @ np.column_stack([rotation @ cam_from_px, translation])


@njit(cache=True)
def transfer(matrix, u, v, depth):
    """Return pixel and depth in the target (`px_from_px`) of a pixel of the source; NaN where it is behind it."""
    a = matrix[0, 0] * u + matrix[0, 1] * v + matrix[0, 2]
    b = matrix[1, 0] * u + matrix[1, 1] * v + matrix[1, 2]
    c = matrix[2, 0] * u + matrix[2, 1] * v + matrix[2, 2]
    z = depth * c + matrix[2, 3]
    if not z > 0:
        return np.nan, np.nan, np.nan
    return (depth * a + matrix[0, 3]) / z, (depth * b + matrix[1, 3]) / z, z
