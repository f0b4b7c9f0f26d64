"""The paper punch on a desk covered with print."""

from __future__ import annotations

from threedfs.synthetic.light import Light
from threedfs.synthetic.objects.paper_punch import make_paper_punch
from threedfs.synthetic.room import Room
from threedfs.synthetic.scene import Scene
from threedfs.synthetic.sensor import Sensor
from threedfs.synthetic.solid import Material
from threedfs.synthetic.table import Table
from threedfs.synthetic.tabletop import Take, walk
from threedfs.synthetic.textures import printed, speckled
from threedfs.synthetic.things import card, lay_around, note, page, wrapping


def make_take() -> Take:
    """Make the take."""
    solid = make_paper_punch()
    support = Material(printed((0.66, 0.64, 0.58), (0.04, 0.04, 0.05), 0.0062, seed=1310), 0.02, 20)
    things = (page(1311, (0.148, 0.21)), card(1312), page(1313), note(1314), wrapping(1316))
    table = Table((0.58, 0.48), support, lay_around(solid, things, seed=134, gap=(0.01, 0.05)))
    room = Room(
        (-2.2, -1.9, -0.74),
        (2.1, 2.2, 1.9),
        speckled((0.26, 0.24, 0.22), (0.12, 0.1, 0.1), 0.04, 0.4, seed=133),
        wall_seed=135,
    )
    light = Light((0.4, 0.9, 1.4), 0.25, (1.85, 1.78, 1.62), (0.22, 0.22, 0.22))
    path = walk(solid, seed=136, start=-10.0, turns=0.90, elevation=(20.0, 52.0), waves=1.4)
    return Take(
        Scene(solid, table, room, light),
        path,
        Sensor(gain=1.45, drift=0.09, shot_noise=0.013, seed=137),
        shutter=1 / 60,
    )
