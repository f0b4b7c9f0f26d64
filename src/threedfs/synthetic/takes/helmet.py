"""The helmet on the floor: plain tiles, with papers around."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.helmet import make_helmet
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.surfaces import tiled
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled
from threedfs.synthetic.things import card, lay_around, napkin, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_helmet()
    support = Material(tiled((0.46, 0.43, 0.38), (0.22, 0.20, 0.18), 0.30, 0.006, seed=1710), 0.20, 90)
    things = (
        page(1711, (0.148, 0.21)),
        wrapping(1712, (0.16, 0.12)),
        page(1713),
        napkin(1714, (0.15, 0.15)),
        card(1716),
        page(1717, (0.148, 0.21)),
        card(1718),
    )
    table = Table((1.6, 1.5), support, lay_around(solid, things, seed=174, gap=(0.02, 0.10)))
    room = Room(
        (-2.3, -2.1, -0.03),
        (2.4, 2.2, 2.4),
        speckled((0.3, 0.28, 0.25), (0.22, 0.2, 0.18), 0.05, 0.5, seed=173),
        wall_seed=175,
    )
    light = Light((-0.7, 0.9, 1.8), 0.25, (3.7, 3.6, 3.4), (0.25, 0.25, 0.26))
    path = walk(solid, seed=176, start=-45.0, turns=1.02, elevation=(20.0, 52.0), waves=1.2)
    return Take(Scene(solid, table, room, light), path, Sensor(gain=1.3, drift=0.10, seed=177), shutter=1 / 70)
