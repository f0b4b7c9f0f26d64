"""Parameters of the fuse_scene stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.errors import UserError
from threedfs.params.field import parameter
from threedfs.params.fusion import FusionSettings


@dataclass(frozen=True)
class FuseSceneParams(FusionSettings):
    """How the scene is fused to find the support plane and the object."""

    region_deviations: float = parameter(
        2.0,
        "half the side of the region of interest along each axis, around the median of the sparse points",
        unit="standard deviation of the points",
        equation="Sec. 3.4.1",
        exclusive_minimum=0.0,
    )
    region_least_reach: float = parameter(
        0.5,
        "the region of interest holds everything within this distance of what the cameras look at (paper: 0)",
        unit="viewing distance",
        minimum=0.0,
    )
    region_reach: float = parameter(
        1.0,
        "the region of interest ends at this distance from what the cameras look at (paper: no end)",
        unit="viewing distance",
        exclusive_minimum=0.0,
    )

    def __post_init__(self) -> None:
        """Refuse values that do not fit each other."""
        if self.region_least_reach > self.region_reach:
            raise UserError(
                "configuration, fuse_scene: expected region_least_reach <= region_reach, got "
                f"{self.region_least_reach} and {self.region_reach}."
            )
