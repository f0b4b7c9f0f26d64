"""Parameters of the texture stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class TextureParams:
    """How the mesh is simplified and painted from the photographs."""

    tolerance: float = parameter(
        0.001,
        "distance by which a vertex may lie off the faces that replace it; 0 keeps all faces",
        unit="diagonal of the mesh's box",
        minimum=0.0,
        maximum=0.1,
    )
    views: int = parameter(
        200, "most photographs painted from, at uniform steps of those there are", minimum=1, maximum=254
    )
    held_out_step: int = parameter(
        10,
        "every so many photographs one is left out, to compare pictures of the mesh with; of fewer than three times as "
        "many none; 0 for none",
        minimum=0,
    )
    seam_cost: float = parameter(
        0.5,
        "cost of a cut between two pieces of the texture along a mean edge, relative to that of laying out a mean face "
        "by a photograph that shows it with no area",
        minimum=0.0,
    )
    texels: float = parameter(
        1.5,
        "texels along a row for each pixel of the photograph that gives a piece of the texture its shape",
        exclusive_minimum=0.0,
        maximum=4.0,
    )
