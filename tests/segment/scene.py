"""A red ball on a table with a pattern, seen from around: images, depth and field, exact."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.projection import backproject, backproject_map, pixel_grid
from threedfs.locate.find import find_object
from threedfs.segment.gather import Scene
from threedfs.segment.superpixels import split_image
from threedfs.types import Box, Camera, Plane, Support, View

CAMERA = Camera(120, 90, 130.0, 130.0, 59.5, 44.5)
RADIUS, CLIP = 0.2, 0.08
CENTRE = np.array([0.0, 0.0, RADIUS])
PLANE = Plane(np.array([0.0, 0.0, 1.0]), 0.0)


def look(angle: float) -> View:
    """Return a view of the ball from a direction around it, slightly from above."""
    eye = np.array([1.1 * np.cos(angle), 1.1 * np.sin(angle), 0.8])
    forward = (CENTRE - eye) / np.linalg.norm(CENTRE - eye)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = -pose[:3, :3] @ eye
    return View(f"{angle:.2f}", CAMERA, pose)


def shoot(view: View, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return image (H, W, 3), depth (H, W) and true mask (H, W) of a view."""
    u, v = pixel_grid(CAMERA)
    one = backproject(view, np.stack([u, v], axis=-1), np.ones(u.shape)) - view.centre
    offset = view.centre - CENTRE
    a, b, c = (one**2).sum(-1), (one * offset).sum(-1), (offset**2).sum() - RADIUS**2
    root = b**2 - a * c
    ball = root > 0
    depth = np.where(ball, (-b - np.sqrt(np.maximum(root, 0))) / a, -view.centre[2] / np.minimum(one[..., 2], -1e-3))
    points = view.centre + depth[..., None] * one
    stripes = np.sin(25 * points[..., 0]) + np.sin(31 * points[..., 1])
    table = np.stack([110 + 25 * stripes, 100 + 25 * stripes, 95 + 10 * stripes], axis=-1)
    shade = 140 + 90 * (points - CENTRE)[..., 2] / RADIUS
    colour = np.where(ball[..., None], np.stack([shade, 0.3 * shade, 0.25 * shade], axis=-1), table)
    return np.clip(colour + rng.normal(0, 2, colour.shape), 0, 255).astype(np.uint8), depth, ball


def make_scene(views: int = 8, shrink: float = 0.0, size: int = 40) -> tuple[Scene, dict[str, np.ndarray]]:
    """Return the scene, its field that of a ball smaller by `shrink`, and the true masks."""
    rng = np.random.default_rng(0)
    looks = [look(angle) for angle in np.linspace(0, 2 * np.pi, views, endpoint=False)]
    box = Box(np.eye(3), np.array([-0.32, -0.32, -0.1]), np.array([0.32, 0.32, 0.5]))
    grid = cover_box(box, size)
    centres = voxel_centres(grid)
    ball = np.linalg.norm(centres - CENTRE, axis=-1) - (RADIUS - shrink)
    sdf = np.clip(np.minimum(ball, centres[..., 2]) / CLIP, -1, 1).astype(np.float32)
    shots = {view.name: shoot(view, rng) for view in looks}
    valid = np.ones(CAMERA.shape, bool)
    blank = np.zeros(CAMERA.shape, np.float32)
    scene = Scene(
        find_object(
            grid,
            sdf,
            np.full(grid.shape, views, np.uint8),
            Support(PLANE, box, {}),
            looks,
            [backproject_map(view, shots[view.name][1]).reshape(-1, 3) for view in looks],
            least_height=grid.spacing,
            reach=0.2,
        ),
        sdf,
        box,
        views={view.name: view for view in looks},
        images={name: image for name, (image, _, _) in shots.items()},
        valid=dict.fromkeys(shots, valid),
        superpixels={
            name: split_image(image, valid, blank, area=21.6, compactness=10.0) for name, (image, _, _) in shots.items()
        },
        depth={name: depth for name, (_, depth, _) in shots.items()},
        confidence={name: np.ones(CAMERA.shape, np.float32) for name in shots},
        semidense={name: depth for name, (_, depth, _) in shots.items()},
    )
    return scene, {name: mask for name, (_, _, mask) in shots.items()}
