"""Parameters of the deform stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class DeformParams:
    """How the zero level of the fused field is moved onto surface points."""

    rbf_width: float = parameter(
        0.03,
        "distance at which a basis function of the correction falls to 1/e (paper: 0.1)",
        unit="scene unit",
        symbol="sigma",
        equation="Eq. 17",
        exclusive_minimum=0.0,
    )
    controls: int = parameter(
        4000, "basis functions of the correction", symbol="C", equation="Eq. 17", minimum=2, maximum=20000
    )
    control_level: float = parameter(
        0.5,
        "half of the basis functions lie where the field is nearer to zero than this",
        unit="clip distance",
        equation="Sec. 3.3.2",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    surface_points: int = parameter(
        50000,
        "surface points drawn for the fit, all where there are fewer (paper: 500)",
        equation="Eq. 18",
        minimum=50,
        maximum=1000000,
    )
    cell: float = parameter(
        1.5,
        "side of the cells in which surface points are averaged before they are drawn; 0: not at all (paper)",
        unit="voxel",
        minimum=0.0,
        maximum=10.0,
    )
    scatter: float = parameter(
        0.6,
        "distance of points from the mean of those beside them, in the median, up to which they count fully; "
        "beyond, by the square of the ratio; acts with cell",
        unit="voxel",
        exclusive_minimum=0.0,
    )
    anchors: int = parameter(
        500,
        "points drawn on each of the level sets 0.9 and -0.9, where the field is not to change",
        equation="Eq. 18",
        minimum=0,
        maximum=10000,
    )
    ridge: float = parameter(
        1.0, "weight of the size of the coefficients", symbol="lambda", equation="Eq. 18", exclusive_minimum=0.0
    )
    reach: float = parameter(
        0.9,
        "points count where the field is nearer to zero than this",
        unit="clip distance",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    min_cosine: float = parameter(
        0.5,
        "least cosine between a point's normal and the field's gradient; -1 takes and trusts all points (paper)",
        minimum=-1.0,
        maximum=1.0,
    )
    full_sightings: int = parameter(
        4, "keyframes that see a point for it to be trusted fully; acts where min_cosine is above -1", minimum=1
    )
    reweightings: int = parameter(
        5,
        "times that points far from the corrected zero level lose weight and the fit is made again (paper: 0)",
        minimum=0,
        maximum=50,
    )
    residual_scale: float = parameter(
        0.1,
        "distance from the corrected zero level at which a point's weight halves; acts with reweightings",
        unit="clip distance",
        exclusive_minimum=0.0,
    )
    keep_apart: bool = parameter(True, "whether solids that the field holds apart stay so (paper: off)")
