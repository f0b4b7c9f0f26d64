"""The monster on a counter of terrazzo, among papers."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.godzilla import make_godzilla
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import speckled
from threedfs.synthetic.things import card, lay_around, napkin, note, page


def make_take() -> Take:
    """Make the take."""
    solid = make_godzilla()
    support = Material(speckled((0.50, 0.48, 0.44), (0.17, 0.14, 0.12), 0.009, 0.35, seed=2010), 0.15, 80)
    things = (page(2011), napkin(2012), card(2013), note(2014), page(2016))
    table = Table((0.62, 0.52), support, lay_around(solid, things, seed=204, gap=(0.01, 0.06)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.27, 0.25, 0.23), (0.14, 0.13, 0.12), 0.05, 0.5, seed=203),
        wall_seed=205,
    )
    light = Light((0.8, 0.6, 1.4), 0.18, (2.05, 1.95, 1.80), (0.21, 0.21, 0.22))
    path = walk(solid, seed=206, start=-130.0, turns=1.0, elevation=(14.0, 44.0))
    return Take(Scene(solid, table, room, light), path, Sensor(gain=1.5, drift=0.09, seed=207), shutter=1 / 60)
