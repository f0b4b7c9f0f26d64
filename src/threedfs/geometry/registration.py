"""Depth images of a depth camera that stands beside the colour camera, as the colour camera would have them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.types import Camera


def register_depth(
    depth: np.ndarray, intrinsics: Sequence[float], offset: Sequence[float], colour: Camera
) -> np.ndarray:
    """Carry each pixel of a depth image to the colour image; where several meet, the nearest counts.

    Parameters
    ----------
    depth : (H, W) float64
        Along the depth camera's z axis, NaN where unknown.
    intrinsics : (4,) sequence of float
        fx, fy, cx, cy of the depth camera in pixels of its image, integer pixel centres.
    offset : (3,) sequence of float
        Where the depth camera stands in the axes of the colour camera, in the unit of the depth; the axes of both are
        parallel.
    colour : Camera
        Of the colour image.

    Returns
    -------
    (H', W') float64
        Depth along the colour camera's z axis; NaN where no pixel lands: beyond the depth image, behind what only the
        colour camera sees, and, if its focal length is the longer, between pixels.
    """
    rows, columns = np.nonzero(np.isfinite(depth))
    z = depth[rows, columns]
    fx, fy, cx, cy = intrinsics
    x, y, z = (columns - cx) / fx * z + offset[0], (rows - cy) / fy * z + offset[1], z + offset[2]
    u, v = np.floor(colour.fx * x / z + colour.cx + 0.5), np.floor(colour.fy * y / z + colour.cy + 0.5)
    inside = (z > 0) & (u >= 0) & (v >= 0) & (u < colour.width) & (v < colour.height)
    registered = np.full(colour.shape, np.inf)
    np.minimum.at(registered, (v[inside].astype(np.int64), u[inside].astype(np.int64)), z[inside])
    return np.where(np.isfinite(registered), registered, np.nan)
