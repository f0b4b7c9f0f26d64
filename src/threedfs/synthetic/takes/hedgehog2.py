"""The hedgehog again: on a coarse cloth, hard light from behind, the other way round."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.hedgehog import make_hedgehog
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled, woven
from threedfs.synthetic.things import card, lay_around, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_hedgehog()
    support = Material(woven((0.48, 0.40, 0.30), (0.30, 0.14, 0.10), 0.0044, seed=1910))
    things = (page(1911), wrapping(1912), card(1913), card(1914), page(1916, (0.074, 0.105)))
    table = Table((0.62, 0.55), support, lay_around(solid, things, seed=194, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.36, 0.34, 0.3), (0.18, 0.18, 0.2), 0.02, 0.5, seed=193),
        wall_seed=195,
    )
    light = Light((-0.7, 0.8, 1.1), 0.06, (2.0, 1.95, 1.9), (0.17, 0.18, 0.20))
    path = walk(solid, seed=196, start=110.0, turns=-0.82, elevation=(28.0, 60.0), waves=2.0, jolts=4)
    return Take(
        Scene(solid, table, room, light), path, Sensor(gain=1.6, drift=0.13, shot_noise=0.016, seed=197), shutter=1 / 45
    )
