"""Parameters of the poisson stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class PoissonParams:
    """How surface points become a mesh without any field of depth maps."""

    octree_depth: int = parameter(8, "the surface has up to 2^octree_depth cells along its side", minimum=3, maximum=13)
    clearance: float = parameter(
        0.01,
        "points within this distance of the support plane are left out: they belong to the table",
        unit="longest side of the object's box",
        minimum=0.0,
    )
    min_sightings: int = parameter(
        3,
        "keyframes that see a point for it to count: no field holds the surface against points that are wrong",
        minimum=1,
    )
