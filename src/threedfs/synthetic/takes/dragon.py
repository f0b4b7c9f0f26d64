"""The dragon on a walnut table, warm lamp."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.dragon import make_dragon
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
    solid = make_dragon()
    support = Material(wood((0.30, 0.17, 0.09), (0.08, 0.04, 0.02), 0.14, seed=1010), 0.06, 60)
    things = (page(1011), card(1012), napkin(1013), note(1014), page(1016, (0.074, 0.105)), wrapping(1017))
    table = Table((0.65, 0.50), support, lay_around(solid, things, seed=104, gap=(0.01, 0.06)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.3, 0.25, 0.21), (0.13, 0.12, 0.14), 0.03, 0.4, seed=103),
        wall_seed=105,
    )
    light = Light((0.7, -0.6, 1.3), 0.15, (1.95, 1.70, 1.40), (0.20, 0.21, 0.23))
    path = walk(solid, seed=106, start=-70.0, turns=0.95, elevation=(18.0, 48.0))
    return Take(
        Scene(solid, table, room, light),
        path,
        Sensor(gain=1.65, drift=0.10, shot_noise=0.014, seed=107),
        shutter=1 / 60,
    )
