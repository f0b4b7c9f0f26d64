"""Between pixels, depths and world points."""

from __future__ import annotations

import numpy as np

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
    """Return unit normals (H, W, 3) in camera axes, facing the camera, by central differences; NaN where undefined."""
    u, v = pixel_grid(camera)
    points = np.stack([(u - camera.cx) / camera.fx * depth, (v - camera.cy) / camera.fy * depth, depth], axis=-1)
    normal = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.where((normal * points).sum(-1, keepdims=True) > 0, -normal, normal)
