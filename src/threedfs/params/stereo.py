"""Parameters of patch-match stereo."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.errors import UserError
from threedfs.params.field import parameter


@dataclass(frozen=True)
class StereoParams:
    """How slanted patches are sought and compared."""

    views: int = parameter(5, "neighbours of the keyframe that a patch is sought in", minimum=1)
    best_views: int = parameter(3, "of these, those that match best decide; the others may not see it", minimum=1)
    radius: int = parameter(3, "patches are (2 radius + 1) pixels wide", unit="px", minimum=1, maximum=10)
    stride: int = parameter(1, "distance of the samples in a patch", unit="px", minimum=1, maximum=5)
    likeness: float = parameter(
        20.0,
        "difference from the patch's centre at which a sample's weight falls to 1/e",
        unit="grey level",
        exclusive_minimum=0,
    )
    variance_floor: float = parameter(
        2.0, "added to the variance of each patch: what noise alone would give", unit="grey levels^2", minimum=0
    )
    least_variance: float = parameter(
        4.0, "variance below which a patch is not sought", unit="grey levels^2", minimum=0
    )
    levels: int = parameter(3, "levels of the image pyramid", minimum=1, maximum=6)
    rounds: int = parameter(4, "sweeps over the coarsest level; half as many on each finer one", minimum=1)

    def __post_init__(self) -> None:
        """Refuse values that do not fit each other."""
        if self.best_views > self.views:
            raise UserError(
                f"configuration, stereo: expected best_views <= views, got {self.best_views} and {self.views}."
            )
