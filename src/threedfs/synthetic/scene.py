"""A scene: one object on a table in a lit room."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.synthetic.light import Light
from threedfs.synthetic.room import Room
from threedfs.synthetic.solid import Solid
from threedfs.synthetic.table import Table


@dataclass(frozen=True)
class Scene:
    """What there is to see. World: z up, the table's top at z = 0, the object near the origin."""

    solid: Solid
    table: Table
    room: Room
    light: Light
