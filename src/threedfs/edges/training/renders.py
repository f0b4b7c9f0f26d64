"""Pictures of rendered still lifes: contours from depth, normals and the borders of things."""

from __future__ import annotations

import numpy as np

from threedfs.edges.training.leaves import record
from threedfs.edges.training.picture import Picture
from threedfs.geometry.rigid import look_at
from threedfs.geometry.vectors import normalise
from threedfs.synthetic import fields, surfaces, textures
from threedfs.synthetic.light import Light
from threedfs.synthetic.render import Renderer, pixel_rays
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.table import Table
from threedfs.synthetic.things import card, lay_around, napkin, note, page, wrapping
from threedfs.types import Camera, View

_CREASE = np.cos(np.radians(40))
_JUMP = 0.01  # from the tangent plane of a neighbour: a step in depth, scene units
_TRAY = 0.16  # half its side, scene units


def render_still_life(views: int, width: int, rng: np.random.Generator) -> list[Picture]:
    """Render a random group of things on a table, 4:3, from random views."""
    parts, scene = _make_scene(rng)
    renderer = Renderer(scene, shadow_rays=24, ambient_rays=24, shadow_spacing=0.006)
    height = width * 3 // 4
    camera = Camera(width, height, 0.85 * width, 0.85 * width, (width - 1) / 2, (height - 1) / 2)
    pictures = []
    for index in range(views):
        azimuth, elevation = rng.uniform(0, 2 * np.pi), np.radians(rng.uniform(22, 68))
        outward = np.array(
            [np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)]
        )
        target = np.array([0, 0, 0.04]) + 0.04 * rng.standard_normal(3)
        view = View(f"{index:06d}", camera, look_at(target + rng.uniform(0.35, 0.8) * outward, target, (0.0, 0.0, 1.0)))
        shifts = ((-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25))
        light = sum(renderer.radiance(view, shift) for shift in shifts) / len(shifts)
        sensor = Sensor(gain=float(rng.uniform(1.0, 2.2)), shot_noise=0.0, read_noise=0.0, seed=index)
        image = record(sensor.record(light, index, 0.0).astype(np.float32) / 255, rng)
        pictures.append(Picture(image, *_link(renderer, parts, view)))
    return pictures


def _make_scene(rng):
    """Return the parts of the group and the scene around it."""
    tray = Part(fields.box((0, 0, 0.0), (_TRAY, _TRAY, 0.006)), _material(rng))
    parts = [tray, *(Part(_shape(rng), _material(rng)) for _ in range(int(rng.integers(4, 10))))]
    solid = build_solid(parts, (-0.25, -0.25, -0.01), (0.25, 0.25, 0.3), 0.0035)
    makers = (page, card, napkin, wrapping, note)
    things = [makers[rng.integers(len(makers))](int(rng.integers(10000))) for _ in range(int(rng.integers(2, 6)))]
    sheets = lay_around(solid, things, int(rng.integers(10000)))
    table = Table((0.6, 0.5), _material(rng), sheets)
    floor = textures.speckled((0.30, 0.25, 0.21), (0.13, 0.12, 0.14), 0.03, 0.4, seed=int(rng.integers(10000)))
    room = Room((-2.2, -2.0, -0.75), (2.1, 2.2, 1.9), floor, wall_seed=int(rng.integers(10000)))
    angle, ambient = rng.uniform(0, 2 * np.pi), rng.uniform(0.1, 0.4)
    place = (1.1 * float(np.cos(angle)), 1.1 * float(np.sin(angle)), float(rng.uniform(0.7, 1.5)))
    light = Light(place, float(rng.uniform(0.03, 0.25)), (1.9, 1.8, 1.6), (ambient, ambient, 1.1 * ambient))
    return parts, Scene(solid, table, room, light)


def _shape(rng):
    """Make a body that stands on the tray."""
    x, y = rng.uniform(-0.13, 0.13, 2)
    size = float(np.exp(rng.uniform(np.log(0.015), np.log(0.06))))
    tall = float(rng.uniform(0.6, 2.0)) * size
    kind = rng.integers(6)
    turn = rng.uniform(0, np.pi)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    if kind == 0:
        return fields.sphere((x, y, 0.9 * size), size)
    if kind == 1:
        return fields.ellipsoid((x, y, 0.9 * tall), (size, size * rng.uniform(0.5, 1), tall))
    if kind == 2:
        return fields.place(
            fields.box((0, 0, tall), (size, size * rng.uniform(0.4, 1), tall), 0.002), (x, y, 0.0), rotation
        )
    if kind == 3:
        return fields.cylinder((x, y, 0.0), (x, y, 2 * tall), 0.7 * size, 0.002)
    if kind == 4:
        lean = rng.uniform(-0.05, 0.05, 2)
        return fields.round_cone((x, y, 0.01), (x + lean[0], y + lean[1], 2 * tall), 0.6 * size, 0.25 * size)
    return fields.torus((x, y, 0.8 * size), (np.cos(turn), np.sin(turn), 0.0), 0.75 * size, 0.2 * size)


def _material(rng) -> Material:
    seed = int(rng.integers(1 << 20))
    level = rng.uniform(0.05, 0.85, 4)
    colours = [tuple(np.clip(grey * (1 + 0.35 * rng.standard_normal(3)), 0.02, 0.9)) for grey in level]
    a, b, c, _ = colours
    makers: tuple = (
        lambda: textures.plain(a, 0.04, 0.03, seed),
        lambda: textures.plain(a, 0.15, 0.05, seed),
        lambda: textures.plain(a, 0.02, 0.03, seed),
        lambda: textures.wood(a, b, float(rng.uniform(0.05, 0.15)), seed),
        lambda: textures.woven(a, b, float(rng.uniform(0.002, 0.004)), seed),
        lambda: textures.speckled(a, b, float(rng.uniform(0.004, 0.02)), 0.4, seed),
        lambda: textures.scaly(a, b, float(rng.uniform(0.005, 0.015)), seed),
        lambda: surfaces.stony(a, b, c, 0.01, seed),
        lambda: surfaces.scattered(a, colours[1:], float(rng.uniform(0.006, 0.02)), seed),
        lambda: textures.printed(a, b, float(rng.uniform(0.005, 0.01)), seed),
    )
    texture: Texture = makers[rng.integers(len(makers))]()
    return Material(texture, float(rng.choice([0.0, 0.05, 0.3])), float(rng.uniform(10, 120)))


def _link(renderer, parts, view):
    """Return `right` and `down` of a view: neighbours on one surface of one thing, without a crease or a step."""
    scene: Scene = renderer.scene
    depth, on_object = renderer.measure(view)
    origins, directions = pixel_rays(view)
    points = origins + depth.reshape(-1, 1) * directions
    thing, normals = _name_surfaces(scene, points, on_object.ravel())
    rows = np.flatnonzero(on_object)
    normals[rows] = _normals_of(parts, scene.solid, points[rows])
    shape = depth.shape
    points, normals, thing = points.reshape(*shape, 3), normals.reshape(*shape, 3), thing.reshape(shape)
    links = []
    for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        step = points[other] - points[one]
        apart = np.minimum(np.abs((step * normals[one]).sum(-1)), np.abs((step * normals[other]).sum(-1)))
        joined = (thing[one] == thing[other]) & ((normals[one] * normals[other]).sum(-1) > _CREASE) & (apart < _JUMP)
        full = np.ones(shape, bool)
        full[one] = joined
        links.append(full)
    return links


def _name_surfaces(scene, points, on_object):
    """Number the thing (N,) that each point belongs to, and give normals (N, 3) of table and room."""
    thing = np.zeros(len(points), np.int32)
    normals = np.zeros_like(points)
    table, room = scene.table, scene.room
    half = np.asarray(table.half)
    on_table = np.all(np.abs(points[:, :2]) < half + 1e-6, axis=1) & (np.abs(points[:, 2]) < 1e-6)
    on_side = np.all(np.abs(points[:, :2]) < half + 1e-6, axis=1) & (points[:, 2] > -table.thickness - 1e-6) & ~on_table
    # Walls: the face of the room that is nearest.
    gaps = np.concatenate([points - np.asarray(room.low), np.asarray(room.high) - points], axis=1)
    wall = np.abs(gaps).argmin(axis=1)
    normals[np.arange(len(points)), wall % 3] = np.where(wall < 3, 1.0, -1.0)
    thing[:] = 1 + wall
    edge = half - np.abs(points[:, :2])
    side = edge.argmin(axis=1)
    rows = np.flatnonzero(on_side)
    thing[rows] = 10
    normals[rows] = 0
    normals[rows, side[rows]] = np.sign(points[rows, side[rows]])
    thing[on_table], normals[on_table] = 11, (0.0, 0.0, 1.0)
    for number, sheet in enumerate(table.sheets):
        local = np.abs(sheet.local(points)[:, :2])
        thing[on_table & np.all(local < sheet.half, axis=1)] = 20 + number
    rows = np.flatnonzero(on_object)
    thing[rows] = 100 + scene.solid.material_of(points[rows])
    return thing, normals


def _normals_of(parts: list[Part], solid: Solid, points: np.ndarray) -> np.ndarray:
    """Unit normals (N, 3) of the parts that points lie on."""
    part_of = solid.material_of(points)
    normals = np.zeros_like(points)
    step = 5e-4
    for number, part in enumerate(parts):
        on = np.flatnonzero(part_of == number)
        if len(on):
            slopes = [part.field(points[on] + step * axis) - part.field(points[on] - step * axis) for axis in np.eye(3)]
            normals[on] = normalise(np.column_stack(slopes) + 1e-12)
    return normals
