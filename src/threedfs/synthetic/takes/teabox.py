"""The tea caddy on a stone counter, two metres from a window."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.teabox import make_teabox
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.surfaces import stony
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled
from threedfs.synthetic.things import card, lay_around, napkin, note, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_teabox()
    support = Material(stony((0.16, 0.17, 0.18), (0.40, 0.38, 0.35), (0.50, 0.49, 0.46), 0.16, seed=1510), 0.25, 110)
    things = (napkin(1511), card(1512), page(1513), wrapping(1514, (0.08, 0.06)), note(1516))
    table = Table((0.62, 0.45), support, lay_around(solid, things, seed=154, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.33, 0.3, 0.27), (0.2, 0.17, 0.14), 0.06, 0.4, seed=153),
        wall_seed=155,
    )
    light = Light((0.9, 0.4, 1.25), 0.20, (1.95, 1.90, 1.85), (0.22, 0.22, 0.23))
    path = walk(solid, seed=156, start=-120.0, turns=1.0, elevation=(15.0, 45.0))
    return Take(
        Scene(solid, table, room, light), path, Sensor(gain=1.55, drift=0.08, tint_drift=0.04, seed=157), shutter=1 / 50
    )
