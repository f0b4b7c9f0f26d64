"""Parameters that both fusions have: the scene's and the object's."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class FusionSettings:
    """How depth maps become one signed distance field."""

    longest_side: int = parameter(
        200, "voxels along the longest side of the grid", unit="voxel", equation="Sec. 3.4.1", minimum=8, maximum=800
    )
    clip_distance: float = parameter(
        10.0,
        "distance from the surface at which a view's signed distance is clipped to 1",
        unit="voxel",
        symbol="mu",
        equation="Eq. 14",
        minimum=2.0,
    )
    softmax_hardness: float = parameter(
        0.0,
        "0 makes the soft maximum over views a mean of their votes (paper: 10)",
        symbol="h",
        equation="Eq. 15",
        minimum=0.0,
        maximum=100.0,
    )
    weighting: str = parameter(
        "consistency",
        "what a view's vote counts: the same everywhere, as in the paper (plain), or by its agreement with other views "
        "and by how it faces the surface",
        choices=("plain", "consistency"),
    )
    distrust: float = parameter(
        16.0,
        "handicap in the soft maximum, taken off the exponent, of a vote that no other view agrees with; acts with "
        "consistency weighting",
        minimum=0.0,
        maximum=100.0,
    )
    hidden: float = parameter(
        12.0,
        "handicap of a vote on a voxel at the clip distance behind a view's surface or farther, which the view does "
        "not see (paper: none); acts with consistency weighting",
        minimum=0.0,
        maximum=100.0,
    )
    depth_discontinuity: float = parameter(
        0.02,
        "relative step of inverse depth between neighbouring pixels across which depth is not interpolated",
        minimum=0.0,
    )
    facing: float = parameter(
        1.0,
        "cosine between normal and ray from which a view's vote is trusted fully, less below; 0 for always; acts with "
        "consistency weighting",
        minimum=0.0,
        maximum=1.0,
    )
    trust_blur: float = parameter(
        4.0,
        "standard deviation by which the trust in a view's pixels is smoothed; 0 for none; acts with consistency "
        "weighting",
        unit="px",
        minimum=0.0,
        maximum=50.0,
    )
