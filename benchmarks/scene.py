"""The scene that depth and stereo are timed on: a textured hemisphere before a slanted plane with a blank patch."""

from __future__ import annotations

import numpy as np

from threedfs.depth.zncc import prepare_grey
from threedfs.geometry.projection import backproject, pixel_grid
from threedfs.geometry.rigid import make_transform
from threedfs.types import Camera, View


def make_scene(height: int, width: int) -> tuple[list[View], dict[str, np.ndarray]]:
    """Return the reference and ten neighbours, and their grey images."""
    camera = Camera(width, height, 0.9 * width, 0.9 * width, (width - 1) / 2, (height - 1) / 2)
    angles = np.linspace(0, 2 * np.pi, 10, endpoint=False)
    centres = [(0.0, 0.0)] + [(0.08 * np.cos(a), 0.08 * np.sin(a)) for a in angles]
    views = [View(str(i), camera, make_transform(np.eye(3), [-x, -y, 0.0])) for i, (x, y) in enumerate(centres)]
    valid = np.ones((height, width), bool)
    return views, {view.name: prepare_grey(render(view), valid) for view in views}


def render(view: View) -> np.ndarray:
    """Ray cast a hemisphere of radius 0.2 at depth 1.1 before the plane z = 1.1 + 0.15 x."""
    u, v = pixel_grid(view.camera)
    ray = np.stack([(u - view.camera.cx) / view.camera.fx, (v - view.camera.cy) / view.camera.fy, np.ones_like(u)], -1)
    x0, y0, _ = view.centre
    plane = (1.1 + 0.15 * x0) / (1 - 0.15 * ray[..., 0])
    offset = np.array([x0, y0, 0.0]) - [0.0, 0.0, 1.1]
    a, b, c = (ray**2).sum(-1), 2 * ray @ offset, offset @ offset - 0.2**2
    inside = b**2 - 4 * a * c
    sphere = np.where(inside > 0, (-b - np.sqrt(np.maximum(inside, 0))) / (2 * a), np.inf)
    points = backproject(view, np.stack([u, v], -1), np.minimum(plane, sphere))
    x, y, z = np.moveaxis(points, -1, 0)
    value = np.sin(61 * x + 3 * np.sin(19 * y)) + np.sin(57 * y + 2 * np.sin(23 * z)) + 0.7 * np.sin(90 * x - 77 * y)
    blank = np.clip((np.hypot(x + 0.3, y - 0.2) - 0.1) / 0.02, 0, 1)
    grey = np.clip(127 + 40 * value * blank + 0.5, 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=-1)
