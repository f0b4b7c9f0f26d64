"""Parameters of the evaluate stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class EvaluateParams:
    """How meshes and masks are scored; nothing but the figures depends on it."""

    surface_samples: int = parameter(
        50000, "points drawn on each surface to compare meshes, or to fit a cylinder", minimum=1000, maximum=10000000
    )
    mesh_thresholds: tuple[float, ...] = parameter(
        (0.25, 0.5, 1.0),
        "distances at which precision, recall and F-score of a mesh are taken",
        unit="% of the true bounding box's diagonal",
        exclusive_minimum=0.0,
        maximum=100.0,
    )
    cylinder_sequences: tuple[str, ...] = parameter(
        (), "sequences whose object is a can, the side of which is compared with its own best-fit cylinder"
    )
