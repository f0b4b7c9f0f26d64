"""A ball with a smooth pattern on it, before a grey wall, and photographs of it in closed form."""

from __future__ import annotations

import numpy as np
import trimesh

from threedfs.geometry.rigid import look_at
from threedfs.texture.charts import Atlas, cut_charts
from threedfs.texture.choose import choose_views, measure_areas
from threedfs.texture.photograph import Photographer
from threedfs.texture.vertices import GRAZING, sample_vertices
from threedfs.types import Camera, Mesh, View

CAMERA = Camera(160, 160, 250.0, 250.0, 79.5, 79.5)
RADIUS = 0.5
WALL = 120


def make_mesh(made: trimesh.Trimesh) -> Mesh:
    """Turn a mesh of trimesh's into one of ours."""
    return Mesh(np.asarray(made.vertices, np.float64), np.asarray(made.faces, np.int64))


def ball(subdivisions: int = 4) -> Mesh:
    """Make a ball around the origin: 5,120 faces, or four times as many with each further subdivision."""
    return make_mesh(trimesh.creation.icosphere(subdivisions=subdivisions, radius=RADIUS))


def look_from(angle: float, height: float = 0.3, name: str = "") -> View:
    """Place a camera around the origin, that many times its distance above it."""
    centre = 2.5 * np.array([np.cos(angle), np.sin(angle), height])
    return View(name or f"{angle:.2f}", CAMERA, look_at(centre, np.zeros(3), np.array([0.0, 0, 1])))


def ring(count: int, height: float = 0.3, phase: float = 0.0) -> list[View]:
    """Place cameras all around."""
    angles = phase + 2 * np.pi * np.arange(count) / count
    return [look_from(angle, height, f"{rank:06d}") for rank, angle in enumerate(angles)]


def pattern(points: np.ndarray) -> np.ndarray:
    """Return the colour (N, 3) float64 of points on the ball, 60 to 200, smooth."""
    x, y, z = points.T / RADIUS
    waves = [np.sin(4 * x + 1) * np.cos(3 * y), np.cos(5 * y + z), np.sin(4 * z + 2 * x)]
    return np.stack([130 + 70 * wave for wave in waves], axis=1)


def photograph(mesh: Mesh, view: View, color=pattern) -> np.ndarray:
    """Photograph a mesh that has the colour of each of its points (N, 3) by a function; (H, W, 3) uint8."""

    def color_hits(hits):
        return color((hits.weights[:, :, None] * mesh.vertices[mesh.faces[hits.triangle]]).sum(axis=1))

    image, shown = Photographer(mesh, color_hits).take(view)
    return np.clip(np.rint(np.where(shown[..., None], image, WALL)), 0, 255).astype(np.uint8)


def everywhere(name: str) -> np.ndarray:
    """Say that every pixel shows the scene."""
    return np.ones(CAMERA.shape, bool)


def cut_ball(photos: dict[str, np.ndarray], subdivisions: int) -> tuple[Mesh, list[View], np.ndarray, Atlas]:
    """Return a ball, its views, the view of each face, and the charts, of a texel to a pixel."""
    mesh, views = ball(subdivisions), ring(8)
    samples = sample_vertices(mesh, views, photos.__getitem__, everywhere, GRAZING)
    chosen = choose_views(mesh, measure_areas(mesh, views, samples), 0.5)
    return mesh, views, chosen, cut_charts(mesh, views, chosen, 1.0)
