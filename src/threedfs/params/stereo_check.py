"""Parameters of the check of stereo matches across keyframes."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class StereoCheckParams:
    """Which matches of patch-match stereo are believed."""

    max_cost: float = parameter(
        0.15, "photometric error, (1 - NCC) / 2, above which a match is dropped", minimum=0, maximum=1
    )
    max_views: int = parameter(
        8, "other keyframes that a match is compared with, those nearest in direction", minimum=1
    )
    depth_tolerance: float = parameter(
        0.01, "relative difference of depth up to which two keyframes agree", exclusive_minimum=0, maximum=1
    )
    min_agreeing: int = parameter(1, "keyframes that must agree with a match", minimum=0)
