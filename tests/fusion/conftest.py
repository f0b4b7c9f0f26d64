"""Scenes of a sphere on a table, with depth maps in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.types import Camera, View

CAMERA = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)


@dataclass(frozen=True)
class TableScene:
    """A sphere of radius `radius` on the plane z = 0, and walls given as planes (normal, offset)."""

    views: list[View]
    radius: float = 0.25
    walls: tuple = ()

    @property
    def centre(self) -> np.ndarray:
        return np.array([0, 0, self.radius])

    def depth(self, view: View) -> np.ndarray:
        """Cast one ray per pixel, (H, W) float64."""
        origin = view.centre
        rays = backproject_map(view, np.ones(view.camera.shape)) - origin  # of camera depth 1
        nearest = np.full(view.camera.shape, np.inf)
        for normal, offset in ((np.array([0.0, 0, 1]), 0.0), *self.walls):
            with np.errstate(divide="ignore"):
                hit = -(origin @ normal + offset) / (rays @ normal)
            nearest = np.where((hit > 0) & (hit < nearest), hit, nearest)
        toward = origin - self.centre
        a, b, c = (rays**2).sum(-1), rays @ toward, toward @ toward - self.radius**2
        inside = b**2 - a * c
        hit = (-b - np.sqrt(np.where(inside > 0, inside, np.nan))) / a
        nearest = np.where(hit > 0, np.fmin(hit, nearest), nearest)
        return np.where(np.isfinite(nearest), nearest, np.nan)

    def image(self, view: View) -> np.ndarray:
        """Colour what a view sees, (H, W, 3) uint8: a red sphere on a table of grey stripes."""
        points = backproject_map(view, self.depth(view))
        on_sphere = np.linalg.norm(points - self.centre, axis=-1) < self.radius + 1e-6
        table = 130 + 40 * np.sin(20 * points[..., 0]) * np.sin(16 * points[..., 1])
        shade = 150 + 200 * (points[..., 2] - self.radius)
        colour = np.where(on_sphere, [shade, 0.2 * shade, 0.2 * shade], [table, table, table])
        return np.moveaxis(np.nan_to_num(colour), 0, -1).clip(0, 255).astype(np.uint8)


def orbit(count: int, height: float = 0.9, distance: float = 1.2, phase: float = 0.1) -> list[View]:
    """Place views on a circle around the object, looking at a point above the table."""
    views = []
    for i, angle in enumerate(phase + 2 * np.pi * np.arange(count) / count):
        centre = np.array([distance * np.cos(angle), distance * np.sin(angle), height])
        views.append(View(f"{i:06d}", CAMERA, look_at(centre, np.array([0, 0, 0.2]), np.array([0.0, 0, 1]))))
    return views


@pytest.fixture(scope="session")
def table() -> TableScene:
    """A sphere on a table seen by twelve views."""
    return TableScene(orbit(12))
