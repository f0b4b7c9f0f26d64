"""The stapler on plain white tiles with a few papers, cold even light."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.stapler import make_stapler
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.surfaces import tiled
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled
from threedfs.synthetic.things import card, lay_around, napkin, note, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_stapler()
    support = Material(tiled((0.62, 0.62, 0.60), (0.34, 0.33, 0.31), 0.20, 0.004, seed=1110), 0.25, 120)
    things = (page(1111), note(1112), card(1113), wrapping(1116, (0.07, 0.05)), note(1117), napkin(1118))
    table = Table((0.60, 0.55), support, lay_around(solid, things, seed=114, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.2, 0.22, 0.24), (0.1, 0.1, 0.12), 0.05, 0.5, seed=113),
        wall_seed=115,
    )
    light = Light((-0.5, -0.9, 1.5), 0.35, (1.55, 1.62, 1.75), (0.28, 0.29, 0.31))
    path = walk(solid, seed=116, start=20.0, turns=-0.85, elevation=(24.0, 55.0), waves=1.2)
    return Take(
        Scene(solid, table, room, light),
        path,
        Sensor(gain=1.35, drift=0.12, shot_noise=0.016, seed=117),
        shutter=1 / 70,
    )
