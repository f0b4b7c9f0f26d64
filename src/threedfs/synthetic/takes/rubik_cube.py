"""The cube on a printed cloth, lamp from the left."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.rubik_cube import make_rubik_cube
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.surfaces import scattered
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled
from threedfs.synthetic.things import card, lay_around, napkin, note, page


def make_take() -> Take:
    """Make the take."""
    solid = make_rubik_cube()
    support = Material(
        scattered(
            (0.50, 0.46, 0.38),
            [(0.30, 0.08, 0.07), (0.10, 0.20, 0.30), (0.14, 0.24, 0.10), (0.55, 0.40, 0.12)],
            0.05,
            seed=1210,
        )
    )
    things = (card(1211), note(1212, (0.025, 0.025)), page(1213, (0.05, 0.07)), napkin(1214, (0.05, 0.05)), note(1216))
    table = Table((0.55, 0.45), support, lay_around(solid, things, seed=124, gap=(0.008, 0.03)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.35, 0.28, 0.22), (0.18, 0.13, 0.1), 0.02, 0.5, seed=123),
        wall_seed=125,
    )
    light = Light((-0.8, 0.3, 1.2), 0.12, (1.75, 1.68, 1.55), (0.20, 0.20, 0.21))
    path = walk(solid, seed=126, start=150.0, turns=1.03, elevation=(25.0, 58.0), share=(0.22, 0.31), waves=1.8)
    return Take(Scene(solid, table, room, light), path, Sensor(gain=1.6, drift=0.07, seed=127), shutter=1 / 55)
