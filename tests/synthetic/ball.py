"""A ball on a table: the scene whose depth, masks and highlights are known in closed form; small enough for tests."""

from __future__ import annotations

import numpy as np
import trimesh

from threedfs.geometry.rigid import look_at
from threedfs.synthetic.film import Film
from threedfs.synthetic.light import Light
from threedfs.synthetic.path import HandheldPath
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material, Solid
from threedfs.synthetic.table import Table
from threedfs.synthetic.textures import plain, speckled
from threedfs.types import Camera, Mesh, View

RADIUS = 0.1
CENTRE = np.array([0.0, 0.0, RADIUS])
CAMERA = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)
GREY = plain((0.4, 0.4, 0.4), mottle=0.0)


def ball_solid(subdivisions: int, material: Material) -> Solid:
    """Make a ball of radius `RADIUS` that touches the table at the origin; its vertices lie on the sphere."""
    ball = trimesh.creation.icosphere(subdivisions, RADIUS)
    mesh = Mesh(np.array(ball.vertices) + CENTRE, np.array(ball.faces, np.int64))
    surface = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    return Solid(mesh, np.array(surface.vertex_normals), (material,), lambda points: np.zeros(len(points), int))


def ball_scene(material: Material | None = None, light: Light | None = None, subdivisions: int = 5) -> Scene:
    """Put the ball on a grey table; the lamp is above, on the side of +x unless another is given."""
    return Scene(
        ball_solid(subdivisions, material or Material(GREY)),
        Table((0.8, 0.8), Material(GREY)),
        Room((-2, -2, -0.7), (2, 2, 1.8), speckled((0.3, 0.3, 0.3), (0.1, 0.1, 0.1), 0.05, 0.5)),
        light or Light((0.8, 0.0, 1.2), 0.1, (2.0, 2.0, 2.0), (0.2, 0.2, 0.2)),
    )


def view_from(centre: tuple[float, float, float], target: np.ndarray = CENTRE, camera: Camera = CAMERA) -> View:
    """Return a view from `centre`, world, with the target in the middle of the image."""
    return View("000000", camera, look_at(np.array(centre), target, np.array([0.0, 0.0, 1.0])))


def tiny_film() -> Film:
    """Make a film of four frames, 64x48, of a coarse ball."""
    return Film(
        scene=ball_scene(Material(speckled((0.5, 0.1, 0.1), (0.7, 0.7, 0.6), 0.02, 0.4), 0.3), subdivisions=2),
        camera=Camera(64, 48, 55.0, 55.0, 31.5, 23.5),
        path=HandheldPath(duration=0.4, turns=0.2, seed=1),
        sensor=Sensor(seed=2),
        frames=4,
        rate=10,
        shutter=1 / 60,
        samples=2,
    )
