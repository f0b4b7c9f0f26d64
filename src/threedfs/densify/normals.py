"""The orientation of matched patches."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.projection import pixel_grid
from threedfs.types import Camera


def patch_normals(camera: Camera, inverse_depth: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Return the normals of slanted patches, towards the camera.

    On the plane n x = e inverse depth is affine in the pixel: w(u, v) = n (ray of u, v) / e. So the normal's first two
    parts are the slopes times the focal lengths, and its third is what is left of w on the optical axis.

    Parameters
    ----------
    camera : Camera
    inverse_depth : (H, W) float, 1 / scene unit, NaN where there is no patch
    slope : (H, W, 2) float
        Change of inverse depth per pixel along columns and rows.

    Returns
    -------
    (H, W, 3) float64
        Unit vectors in the camera's frame, NaN where there is no patch.

    Examples
    --------
    >>> patch_normals(Camera(2, 1, 1, 1, 0, 0), np.array([[0.5, 0.5]]), np.zeros((1, 2, 2)))[0, 0].tolist()
    [-0.0, -0.0, -1.0]
    """
    u, v = pixel_grid(camera)
    along, down = slope[..., 0].astype(np.float64), slope[..., 1].astype(np.float64)
    axial = inverse_depth - along * (u - camera.cx) - down * (v - camera.cy)
    normal = -np.stack([along * camera.fx, down * camera.fy, axial], axis=-1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)
