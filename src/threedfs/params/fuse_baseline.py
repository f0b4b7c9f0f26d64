"""Parameters of the fuse_baseline stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class FuseBaselineParams:
    """How the object is fused by the methods that the soft maximum is compared with."""

    longest_side: int = parameter(
        200, "voxels along the longest side of the grid", unit="voxel", equation="Sec. 3.4.1", minimum=8, maximum=800
    )
    clip_distance: float = parameter(
        10.0,
        "distance from the surface at which a view's signed distance is clipped to 1, and behind which a view says "
        "nothing to a weighted average",
        unit="voxel",
        symbol="mu",
        equation="Eq. 14",
        minimum=2.0,
    )
    thickness_share: float = parameter(
        0.25,
        "largest clip distance as a share of the object's thickness; 0 for no limit (paper)",
        minimum=0.0,
        maximum=1.0,
    )
    depth_discontinuity: float = parameter(
        0.02,
        "relative step of inverse depth between neighbouring pixels across which depth is not interpolated",
        minimum=0.0,
    )
