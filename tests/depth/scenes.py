"""Closed-form scenes for the depth tests: a slanted textured plane seen by cameras on a short baseline."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.depth.zncc import prepare_grey
from threedfs.geometry.projection import pixel_grid
from threedfs.geometry.rigid import make_transform
from threedfs.types import Camera, View

CAMERA = Camera(width=96, height=72, fx=90.0, fy=90.0, cx=47.5, cy=35.5)
NORMAL = np.array([0.25, -0.15, 1.0])
OFFSET = 1.0


def plane_depth(view: View) -> np.ndarray:
    """Depth (H, W) of the plane NORMAL . x = OFFSET in world coordinates."""
    u, v = pixel_grid(view.camera)
    rays = np.stack([(u - view.camera.cx) / view.camera.fx, (v - view.camera.cy) / view.camera.fy, np.ones_like(u)], -1)
    rotation, translation = view.cam_from_world[:3, :3], view.cam_from_world[:3, 3]
    return (OFFSET + NORMAL @ rotation.T @ translation) / (rays @ rotation @ NORMAL)


def texture(points: np.ndarray) -> np.ndarray:
    """A smooth pattern of several scales at world points (..., 3), grey levels."""
    x, y = points[..., 0], points[..., 1]
    value = np.sin(31 * x + 3 * np.sin(9 * y)) + np.sin(27 * y + 2 * np.sin(13 * x)) + 0.7 * np.sin(60 * x - 47 * y)
    return 127 + 40 * value


def render(view: View, blank: bool = False) -> np.ndarray:
    """RGB image (H, W, 3) uint8 of the plane; `blank` leaves the middle third without texture."""
    from threedfs.geometry.projection import backproject_map

    points = backproject_map(view, plane_depth(view))
    grey = texture(points)
    if blank:
        inside = np.maximum(np.abs(points[..., 0]) - 0.15, np.abs(points[..., 1]) - 0.12)
        grey = 127 + (grey - 127) * np.clip(inside / 0.05, 0, 1)  # faded over 4 px: a sharp border would alias
    return cv2.cvtColor(np.clip(grey + 0.5, 0, 255).astype(np.uint8), cv2.COLOR_GRAY2RGB)


def views() -> list[View]:
    """The reference, at the world's origin, and four neighbours about 5 degrees away."""
    shifts = [(0, 0), (0.09, 0), (-0.09, 0.01), (0.01, 0.09), (0, -0.09)]
    return [View(f"{i}", CAMERA, make_transform(np.eye(3), [-x, -y, 0.0])) for i, (x, y) in enumerate(shifts)]


def grey_images(blank: bool = False) -> dict[str, np.ndarray]:
    """Prepared grey images by view name."""
    valid = np.ones(CAMERA.shape, bool)
    return {view.name: prepare_grey(render(view, blank), valid) for view in views()}
