"""The hedgehog on a kitchen table, soft lamp."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.hedgehog import make_hedgehog
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled, wood
from threedfs.synthetic.things import card, lay_around, napkin, note, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_hedgehog()
    support = Material(wood((0.48, 0.30, 0.16), (0.20, 0.10, 0.05), 0.09, seed=1810), 0.07, 70)
    things = (napkin(1811), card(1812), page(1813), note(1814), wrapping(1816))
    table = Table((0.60, 0.48), support, lay_around(solid, things, seed=184, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.22, 0.2, 0.2), (0.34, 0.31, 0.28), 0.04, 0.4, seed=183),
        wall_seed=185,
    )
    light = Light((0.5, -0.7, 1.4), 0.22, (1.95, 1.85, 1.65), (0.21, 0.21, 0.22))
    path = walk(solid, seed=186, start=-80.0, turns=0.98, elevation=(18.0, 50.0))
    return Take(Scene(solid, table, room, light), path, Sensor(gain=1.5, drift=0.08, seed=187), shutter=1 / 65)
