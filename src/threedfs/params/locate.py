"""Parameters of the locate stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.component import ComponentSettings
from threedfs.params.field import parameter


@dataclass(frozen=True)
class LocateParams(ComponentSettings):
    """How the support plane and the object are found in the scene."""

    plane_tolerance: float = parameter(
        1.5, "distance up to which the fused surface lies on the support plane", unit="voxel", exclusive_minimum=0.0
    )
    plane_doublings: int = parameter(
        3, "times that plane_tolerance is doubled while no plane is found, as on a rough surface", minimum=0
    )
    plane_reach: float = parameter(
        0.35,
        "standard deviation of the weight of the surface around what the cameras look at",
        unit="viewing distance",
        exclusive_minimum=0.0,
    )
    plane_max_tilt: float = parameter(
        75.0,
        "largest angle between the support's normal and the cameras' mean upward direction",
        unit="degree",
        exclusive_minimum=0.0,
        maximum=90.0,
    )
    plane_min_share: float = parameter(
        0.15, "least share of the nearby upward-facing surface on the support plane", minimum=0.0, maximum=1.0
    )
    plane_candidates: int = parameter(4000, "planes tried", minimum=1)
    clearance_doublings: int = parameter(
        3,
        "times that locate_object.clearance is doubled while the object is joined with the border of the region",
        minimum=0,
        maximum=8,
    )
    bridge: int = parameter(
        1, "pieces up to twice so far apart count as one object when its box is drawn", unit="voxel", minimum=0
    )
    box_reach: float = parameter(
        0.4,
        "how far around the box images are asked whether they show more of the object, which then enlarges the box; 0: "
        "they are not asked (paper)",
        unit="longest side of the box",
        minimum=0.0,
        maximum=2.0,
    )
    box_margin: float = parameter(
        0.35, "what the box exceeds the object by, both sides together", unit="longest side of the object", minimum=0.0
    )
