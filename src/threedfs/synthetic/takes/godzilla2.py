"""The monster again: on pale stone, bluish daylight, another walk."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.godzilla import make_godzilla
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
    solid = make_godzilla()
    support = Material(stony((0.52, 0.50, 0.47), (0.26, 0.24, 0.24), (0.30, 0.26, 0.22), 0.22, seed=2110), 0.22, 100)
    things = (wrapping(2111), page(2112), card(2113), napkin(2114), note(2116), card(2117))
    table = Table((0.66, 0.50), support, lay_around(solid, things, seed=214, gap=(0.01, 0.06)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.2, 0.2, 0.22), (0.3, 0.29, 0.27), 0.03, 0.5, seed=213),
        wall_seed=215,
    )
    light = Light((-0.9, -0.5, 1.5), 0.35, (1.95, 2.10, 2.35), (0.22, 0.23, 0.26))
    path = walk(solid, seed=216, start=40.0, turns=-0.88, elevation=(20.0, 54.0), waves=1.9, jolts=4)
    return Take(
        Scene(solid, table, room, light),
        path,
        Sensor(gain=1.45, drift=0.12, shot_noise=0.014, seed=217),
        shutter=1 / 50,
    )
