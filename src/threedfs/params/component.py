"""Parameters of the choice of a component as the object: in the scene and on the object's grid."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class ComponentSettings:
    """What speaks for a connected piece of the interior."""

    point_deviation: float = parameter(
        0.05, "largest relative standard deviation of the semi-dense points that support a component", minimum=0.0
    )
    object_reach: float = parameter(
        0.2,
        "standard deviation of a component's worth over its distance from what the cameras look at",
        unit="viewing distance",
        exclusive_minimum=0.0,
    )
