"""Parameters of the cut_object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter
from threedfs.params.smoothing import SmoothingSettings


@dataclass(frozen=True)
class CutObjectParams(SmoothingSettings):
    """How labelled voxels cut the field of the method sdf_2d3d_voxel; the others take the labels as they are."""

    dilation: int = parameter(
        2,
        "voxels by which the object's labels are enlarged before they cut its field",
        equation="Sec. 4.3",
        minimum=0,
        maximum=50,
    )
    fit_masks: bool = parameter(
        True, "carve the field where it sticks out of the masks, and fill it where it leaves gaps in them (paper: no)"
    )
    hull_ramp: float = parameter(
        5.0,
        "distance from the masks' visual hull at which its field is 1; acts with fit_masks",
        unit="voxel",
        exclusive_minimum=0.0,
    )
    hull_tolerance: float = parameter(
        0.1,
        "share of the views that may show a voxel of the visual hull outside their mask; acts with fit_masks",
        minimum=0.0,
        maximum=1.0,
    )
    gap_views: int = parameter(
        2, "views that show a voxel of the visual hull on a gap before it is filled; acts with fit_masks", minimum=1
    )
    medians: int = parameter(
        1,
        "times that the field becomes its median over a voxel and the 6 beside it: pits and spikes go (paper: 0)",
        minimum=0,
        maximum=10,
    )
