"""The keyboard on a light desk, window light from one side."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.keyboard import make_keyboard
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
    solid = make_keyboard()
    support = Material(wood((0.55, 0.43, 0.29), (0.36, 0.25, 0.15), 0.18, seed=1410), 0.08, 80)
    things = (page(1411), napkin(1412), card(1413), page(1414), wrapping(1416), note(1417), card(1418))
    table = Table((0.80, 0.60), support, lay_around(solid, things, seed=144, gap=(0.01, 0.06)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.24, 0.25, 0.28), (0.14, 0.13, 0.12), 0.03, 0.5, seed=143),
        wall_seed=145,
    )
    light = Light((-1.1, -0.4, 1.3), 0.40, (2.2, 2.3, 2.5), (0.21, 0.21, 0.22))
    path = walk(solid, seed=146, start=-95.0, turns=0.80, elevation=(26.0, 58.0), share=(0.26, 0.36), waves=1.3)
    return Take(
        Scene(solid, table, room, light), path, Sensor(gain=1.4, drift=0.10, shot_noise=0.015, seed=147), shutter=1 / 80
    )
