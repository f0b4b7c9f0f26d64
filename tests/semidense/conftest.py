"""Scenes of closed form: textured plane and sphere, seen by cameras on an arc, with exact depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from threedfs.geometry.projection import pixel_grid
from threedfs.geometry.rigid import look_at
from threedfs.types import Camera, Keyframe, View

WIDTH, HEIGHT = 240, 180


@dataclass(frozen=True)
class Scene:
    """A keyframe, the exact images of it and its neighbours, its exact depth and sparse points on its surface."""

    keyframe: Keyframe
    image: np.ndarray
    images: dict[str, np.ndarray]
    depth: np.ndarray
    sparse: np.ndarray

    @property
    def neighbours(self):
        images = [self.images[view.name] for view in self.keyframe.neighbours]
        return [
            (v, image, np.ones(image.shape[:2], bool))
            for v, image in zip(self.keyframe.neighbours, images, strict=True)
        ]


def _rays(view):
    u, v = pixel_grid(view.camera)
    camera = view.camera
    directions = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], axis=-1)
    return directions @ view.cam_from_world[:3, :3]


def _hit(view, shape):
    """Depth and world points of a view: the plane z = 1, with a sphere of radius 0.2 touching it."""
    rays, origin = _rays(view), view.centre
    depth = (1 - origin[2]) / rays[..., 2]
    if shape == "sphere":
        to_centre = origin - np.array([0, 0, 0.8])
        a, b = (rays**2).sum(-1), rays @ to_centre
        inside = b**2 - a * (to_centre @ to_centre - 0.2**2)
        near = (-b - np.sqrt(np.maximum(inside, 0))) / a
        depth = np.where((inside > 0) & (near > 0), near, depth)
    return depth, origin + depth[..., None] * rays


def _paint(points, contrast):
    """Band-limited solid texture: finest wave 5 pixels of the keyframe, so that sampling it is nearly exact."""
    generator = np.random.default_rng(7)
    value = np.zeros(points.shape[:-1])
    for wavelength in (0.025, 0.04, 0.07, 0.15):
        for _ in range(6):
            direction = generator.normal(size=3)
            direction *= 2 * np.pi / wavelength / np.linalg.norm(direction)
            value += np.sin(points @ direction + generator.uniform(0, 2 * np.pi))
    return 128 + contrast * value


@pytest.fixture(scope="session")
def make_scene():
    def make(shape="plane", contrast=12.0, noise=0.0, gain=0.0, neighbour_focal=200.0):
        """`gain`: how much brighter each next neighbour is, in grey levels."""
        generator = np.random.default_rng(3)

        def view_at(name, degrees, lift, focal):
            angle = np.radians(degrees)
            centre = np.array([np.sin(angle), lift, 1 - np.cos(angle)])
            camera = Camera(WIDTH, HEIGHT, focal, focal, WIDTH / 2, HEIGHT / 2)
            return View(name, camera, look_at(centre, np.array([0, 0, 1.0]), np.array([0, -1.0, 0.05])))

        def render(view, offset=0.0):
            grey = _paint(_hit(view, shape)[1], contrast) + offset + noise * generator.normal(size=(HEIGHT, WIDTH))
            return np.repeat(np.clip(np.rint(grey), 0, 255).astype(np.uint8)[..., None], 3, axis=2)

        key = view_at("key", 0, 0, 200.0)
        others = [
            view_at(f"n{i}", degrees, lift, neighbour_focal)
            for i, (degrees, lift) in enumerate([(3, 0), (-3, 0.02), (6, -0.03), (-6, 0), (9, 0.02), (2, 0.08)])
        ]
        depth, points = _hit(key, shape)
        sparse = points.reshape(-1, 3)[generator.choice(depth.size, 60, replace=False)]
        keyframe = Keyframe(key, tuple(others), near=0.4, far=2.5)
        images = {view.name: render(view, gain * i) for i, view in enumerate(others, start=1)}
        return Scene(keyframe, render(key), images, depth, sparse)

    return make
