"""The books on a woollen blanket, evening light."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.books import make_books
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled, woven
from threedfs.synthetic.things import card, lay_around, note, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_books()
    support = Material(woven((0.30, 0.22, 0.16), (0.14, 0.20, 0.26), 0.0052, seed=1610))
    things = (page(1611), card(1612), wrapping(1613), page(1614, (0.074, 0.105)), card(1616), note(1617))
    table = Table((0.80, 0.70), support, lay_around(solid, things, seed=164, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.28, 0.22, 0.18), (0.15, 0.11, 0.09), 0.03, 0.5, seed=163),
        wall_seed=165,
    )
    light = Light((0.6, -0.8, 1.2), 0.14, (2.30, 1.95, 1.50), (0.21, 0.20, 0.19))
    path = walk(solid, seed=166, start=60.0, turns=-0.95, elevation=(22.0, 55.0), waves=1.6)
    return Take(
        Scene(solid, table, room, light),
        path,
        Sensor(gain=1.45, drift=0.10, shot_noise=0.015, seed=167),
        shutter=1 / 60,
    )
