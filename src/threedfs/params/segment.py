"""Parameters of the segment stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SegmentParams:
    """How superpixels and voxels are labelled together."""

    field: str = parameter(
        "fused",
        "the field that is weighed, and cut out by sdf_2d3d_voxel: as fused, or corrected by surface points (paper)",
        choices=("fused", "deformed"),
    )
    outer_level: float = parameter(
        0.5,
        "the over-estimate of the object holds what is joined to it where the field is below this",
        unit="clip distance",
        equation="Sec. 3.4.2",
        minimum=-1.0,
        maximum=1.0,
    )
    outer_height: float = parameter(
        6.0,
        "least height above the clearance for that; nearer to the support its own field is below the level (paper: 0)",
        unit="voxel",
        minimum=0.0,
    )
    outer_margin: int = parameter(
        6,
        "the over-estimate holds everything within this distance of the fused object (paper: 0)",
        unit="voxel",
        minimum=0,
        maximum=100,
    )
    fill_outer: bool = parameter(
        True, "fill the holes of the over-estimate's silhouettes: a field may lack a side of the object (paper: no)"
    )
    inner_level: float = parameter(
        -1.0,
        "superpixels that show the object where its field is below this are its for good; -1 for none (paper: -0.5)",
        unit="clip distance",
        equation="Sec. 3.4.2",
        minimum=-1.0,
        maximum=1.0,
    )
    inner_pieces: str = parameter(
        "object",
        "what the under-estimate is taken from: the object as found, or all of the over-estimate (paper)",
        equation="Sec. 3.4.2",
        choices=("object", "outer"),
    )
    decided_share: float = parameter(
        0.9,
        "share of a superpixel's pixels outside the over-estimate, or inside the under-estimate, that fixes its label",
        equation="Sec. 3.4.2",
        minimum=0.5,
        maximum=1.0,
    )
    first_labels: str = parameter(
        "field",
        "first labels of the band's superpixels: by the silhouette of the fused object, or drawn at random (paper)",
        equation="Sec. 3.4.2",
        choices=("field", "random"),
    )
    empty_level: float = parameter(
        0.9,
        "voxels where the field is above this are empty for good",
        unit="clip distance",
        equation="Sec. 3.4.3",
        minimum=0.0,
        maximum=1.0,
    )
    deepest: float = parameter(
        0.4,
        "voxels of a normalised height below this are background for good (paper: 0.3)",
        symbol="d_n",
        equation="Eq. 24",
        minimum=0.0,
        maximum=0.5,
    )
    color_components: int = parameter(
        10, "components of each colour mixture", equation="Sec. 3.4.3", minimum=1, maximum=100
    )
    color_superpixels: int = parameter(
        5000, "superpixels drawn to learn each mixture from", equation="Sec. 3.4.3", minimum=1
    )
    color_pixels: int = parameter(20000, "pixels drawn from these superpixels", equation="Sec. 3.4.3", minimum=100)
    color_cap: float = parameter(5.0, "largest cost of a colour", equation="Eq. 20", exclusive_minimum=0.0)
    color_weight: float = parameter(1.0, "weight of the colour", equation="Eq. 21", minimum=0.0)
    table: bool = parameter(
        True, "compare pixels with the support surface as other keyframes show it at the same spot (paper: no)"
    )
    table_reach: float = parameter(
        1.0,
        "the picture of the support surface goes so far beyond the object's box; acts with table",
        unit="longest side of the box",
        minimum=0.0,
        maximum=5.0,
    )
    roi: str = parameter(
        "box",
        "what depth outside of which speaks for the background: the object's box, or all that the field's grid covers, "
        "which with fuse_object.grid: region is the region of interest (paper)",
        equation="Eq. 22",
        choices=("box", "grid"),
    )
    roi_weight: float = parameter(
        1.0,
        "weight of the depth outside what roi names (paper: 10)",
        symbol="lambda_roi",
        equation="Eq. 22",
        minimum=0.0,
    )
    silhouette_weight: float = parameter(
        3.0, "weight of the voxels' silhouette (paper: 1)", symbol="lambda_sil", equation="Eq. 23", minimum=0.0
    )
    silhouette_ramp: float = parameter(
        6.0,
        "distance to both sides of the voxels' outline over which their silhouette is soft (paper: 0)",
        unit="voxel",
        minimum=0.0,
    )
    sdf_weight: float = parameter(4.0, "weight of the field", symbol="lambda_sdf", equation="Eq. 25", minimum=0.0)
    scene_weight: float = parameter(
        1.0, "weight of the side of the support plane", symbol="lambda_scene", equation="Eq. 26", minimum=0.0
    )
    carve_weight: float = parameter(
        1.0, "weight of the carving by masks", symbol="lambda_carve", equation="Eq. 27", minimum=0.0
    )
    first_carving: str = parameter(
        "first_labels",
        "masks that carve in the first round: those of the first labels; those of one cut of the images alone, from "
        "which the labels start then; or none, so that averages begin with the second round",
        equation="Eq. 27",
        choices=("first_labels", "cut", "none"),
    )
    carve_tolerance: float = parameter(
        0.1,
        "share of the views up to which a voxel may project outside the masks without being carved (paper: 0)",
        minimum=0.0,
        maximum=1.0,
    )
    pair_weight: float = parameter(
        0.5, "cost of different labels at neighbouring superpixels (paper: 1)", equation="Eq. 28", minimum=0.0
    )
    pair_edge: str = parameter(
        "mean",
        "contour strength along a boundary: mean, times its length; the printed sum over the pixels of both sides; or "
        "that over one side's, half of it",
        equation="Eq. 28",
        choices=("mean", "sum", "one_side"),
    )
    pair_falloff: float = parameter(2.0, "fall-off of that cost with the strength", equation="Eq. 28", minimum=0.0)
    voxel_pair_weight: float = parameter(
        0.3, "cost of different labels at neighbouring voxels (paper: 1)", equation="Sec. 3.4.3", minimum=0.0
    )
    links: str = parameter(
        "surface",
        "voxels that a superpixel is linked with: where its dense depth, confirmed by other views, meets the fused "
        "surface, or those that hold its semi-dense points (paper)",
        equation="Sec. 3.4.1",
        choices=("surface", "semidense"),
    )
    point_deviation: float = parameter(
        0.05,
        "largest relative standard deviation of the semi-dense points that are linked; acts with links: semidense",
        minimum=0.0,
    )
    link_weight: float = parameter(
        0.2, "cost of different labels at linked nodes (paper: 1)", equation="Sec. 3.4.3", minimum=0.0
    )
    link_by_share: bool = parameter(
        True, "a link counts by the share of the superpixel's pixels that it stands for (paper: every link the same)"
    )
    iterations: int = parameter(
        5,
        "rounds of expansion moves, each with new colours and silhouettes",
        equation="Sec. 3.4.4",
        minimum=1,
        maximum=50,
    )
    stop_swaps: int = parameter(
        0, "stop when a round changes fewer labels than this (paper: 6000)", equation="Sec. 3.4.4", minimum=0
    )
    stop_share: float = parameter(
        0.002,
        "stop when a round changes a smaller share of the open labels than this (paper: 0)",
        minimum=0.0,
        maximum=1.0,
    )
    refine: bool = parameter(True, "label the pixels of the band once more, one by one (paper: no)")
    refine_label_weight: float = parameter(
        0.5, "cost of a pixel that leaves the label of its superpixel; acts with refine", minimum=0.0
    )
    refine_pair_weight: float = parameter(
        1.5, "cost of different labels at neighbouring pixels of equal colour; acts with refine", minimum=0.0
    )
    refine_contrast: float = parameter(
        8.0,
        "colour difference at which that cost has fallen to 0.6; acts with refine",
        unit="Lab unit",
        exclusive_minimum=0.0,
    )
