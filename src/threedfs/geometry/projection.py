"""Between pixels, depths and world points."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from threedfs.types import Camera, View


def pixel_grid(camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Return columns u and rows v of every pixel centre, each (H, W) float64."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    return u, v


def project(view: View, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Project world points (..., 3); return pixels (..., 2) as (u, v) and depth (...).

    Pixels of points with depth <= 0 are NaN: they are behind the camera.
    """
    homogeneous = points @ view.px_from_world[:, :3].T + view.px_from_world[:, 3]
    depth = homogeneous[..., 2]
    safe = np.where(depth > 0, depth, np.nan)
    return homogeneous[..., :2] / safe[..., None], depth


def backproject(view: View, pixels: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Return world points (..., 3) of pixels (..., 2) at camera-frame depth (...); NaN stays NaN."""
    camera = view.camera
    x = (pixels[..., 0] - camera.cx) / camera.fx * depth
    y = (pixels[..., 1] - camera.cy) / camera.fy * depth
    in_camera = np.stack([x, y, depth], axis=-1)
    return (in_camera - view.cam_from_world[:3, 3]) @ view.cam_from_world[:3, :3]


def backproject_map(view: View, depth: np.ndarray) -> np.ndarray:
    """Return the (H, W, 3) world points of a depth map (H, W)."""
    u, v = pixel_grid(view.camera)
    return backproject(view, np.stack([u, v], axis=-1), depth)


def inside(camera: Camera, pixels: np.ndarray) -> np.ndarray:
    """Say which pixels (..., 2) lie on the image, between the centres of its outermost pixels; NaN is outside."""
    u, v = pixels[..., 0], pixels[..., 1]
    return (u >= 0) & (u <= camera.width - 1) & (v >= 0) & (v <= camera.height - 1)


def normals_from_depth(camera: Camera, depth: np.ndarray) -> np.ndarray:
    """Return unit normals (H, W, 3) in camera axes by central differences; NaN where undefined.

    They face the camera, as depths are positive.

    Raises
    ------
    ValueError
        If the depth map (H, W) has not the size of the camera's image.
    """
    if depth.shape != camera.shape:
        raise ValueError(f"expected a depth map of {camera.shape}, got one of {depth.shape}")
    normals = np.empty((*depth.shape, 3))
    _find_normals(depth.astype(np.float64), camera.fx, camera.fy, camera.cx, camera.cy, normals)
    return normals


@njit(nogil=True, cache=True, error_model="numpy")
def _find_normals(depth, fx, fy, cx, cy, normals):
    rows, columns = depth.shape
    for row in range(rows):
        up, down = max(row - 1, 0), min(row + 1, rows - 1)
        y = (row - cy) / fy
        for column in range(columns):
            left, right = max(column - 1, 0), min(column + 1, columns - 1)
            x = (column - cx) / fx
            above, below = depth[up, column], depth[down, column]
            on_left, on_right = depth[row, left], depth[row, right]
            # Steps from point to point. Down x right faces the camera.
            down_x = (x * below - x * above) / (down - up)
            down_y = ((down - cy) / fy * below - (up - cy) / fy * above) / (down - up)
            down_z = (below - above) / (down - up)
            right_x = ((right - cx) / fx * on_right - (left - cx) / fx * on_left) / (right - left)
            right_y = (y * on_right - y * on_left) / (right - left)
            right_z = (on_right - on_left) / (right - left)
            normal_x = down_y * right_z - down_z * right_y
            normal_y = down_z * right_x - down_x * right_z
            normal_z = down_x * right_y - down_y * right_x
            length = math.sqrt(normal_x * normal_x + normal_y * normal_y + normal_z * normal_z)
            normals[row, column, 0] = normal_x / length
            normals[row, column, 1] = normal_y / length
            normals[row, column, 2] = normal_z / length
