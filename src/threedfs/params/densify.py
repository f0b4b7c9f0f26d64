"""Parameters of the densify stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class DensifyParams:
    """How surface points are made from matched patches."""

    points: bool = parameter(
        True, "make surface points; off goes on without them, and the zero level of the field is not corrected"
    )
    engine: str = parameter(
        "auto",
        "what matches the patches: our own patch match (cpu); COLMAP's, which needs COLMAP built with CUDA and a GPU "
        "(cuda); COLMAP's where there is both (auto)",
        choices=("auto", "cpu", "cuda"),
    )
    max_cost: float = parameter(
        0.13,
        "photometric error, (1 - NCC) / 2, above which a patch is left out; acts on our own matches",
        minimum=0.0,
        maximum=1.0,
    )
    window_radius: int = parameter(
        5, "patches of COLMAP's own match are (2 window_radius + 1) pixels wide", unit="px", minimum=1, maximum=32
    )
    min_pixels: int = parameter(2, "pixels, of all keyframes together, that a point is made from", minimum=1)
    max_depth_error: float = parameter(
        0.005,
        "relative difference of depth up to which two keyframes see one point",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    max_reprojection_error: float = parameter(
        1.0, "distance in the image up to which two keyframes see one point", unit="px", exclusive_minimum=0.0
    )
    max_normal_error: float = parameter(
        20.0, "angle between normals up to which two keyframes see one point", unit="degree", exclusive_minimum=0.0
    )
