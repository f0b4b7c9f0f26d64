"""Parameters of the consistency stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class ConsistencyParams:
    """How depth maps are checked against each other."""

    depth_tolerance: float = parameter(
        0.007, "relative difference in depth up to which two views see the same surface", exclusive_minimum=0.0
    )
    max_views: int = parameter(
        32, "other keyframes that each depth map is compared with, nearest in direction", minimum=1, maximum=255
    )
    witness_share: float = parameter(
        0.3,
        "share of agreeing views from which a surface may speak against other views",
        minimum=0.0,
        maximum=1.0,
    )
    prior_views: float = parameter(
        0.25, "weight of a pixel's photometric confidence, in agreeing or contradicting views", exclusive_minimum=0.0
    )
    full_share: float = parameter(
        0.75, "share of agreeing views from which a pixel is trusted fully", exclusive_minimum=0.0, maximum=1.0
    )
