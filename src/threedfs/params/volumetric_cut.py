"""Parameters of the volumetric_cut stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class VolumetricCutParams:
    """How voxels alone are cut by colour and photo-consistency, the baseline volumetric_gc."""

    longest_side: int = parameter(
        100, "voxels along the longest side of the grid", unit="voxel", minimum=8, maximum=400
    )
    point_deviation: float = parameter(
        0.05, "largest relative standard deviation of the semi-dense points that vote for a surface", minimum=0.0
    )
    components: int = parameter(10, "components of each colour mixture", minimum=1, maximum=100)
    color_pixels: int = parameter(50000, "pixels drawn to learn each mixture from", minimum=100)
    least_posterior: float = parameter(
        0.8, "mean posterior of the projections above which a voxel is the object's", minimum=0.01, maximum=0.99
    )
    fixation_radius: float = parameter(
        0.1,
        "radius of the disc around what the cameras look at that gives the first colours",
        unit="shorter side of the image",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    pair_weight: float = parameter(0.1, "cost of different labels at neighbouring voxels without a point", minimum=0.0)
    vote_scale: float = parameter(
        2.0, "points in a voxel that lower that cost to 1/e", unit="point", exclusive_minimum=0.0
    )
    iterations: int = parameter(10, "rounds of cuts, each with new colours", minimum=1, maximum=100)
    stop_share: float = parameter(
        0.001, "stop when a round changes a smaller share of the voxels than this", minimum=0.0, maximum=1.0
    )
