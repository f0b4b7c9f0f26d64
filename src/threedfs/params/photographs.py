"""Parameters of the photographs stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class PhotographsParams:
    """How pictures of the painted mesh are compared with photographs; nothing but the figures depends on it."""

    least_pixels: int = parameter(
        500, "pixels of the object that a photograph must show to be compared with", unit="pixel", minimum=50
    )
    surface_samples: int = parameter(
        20000, "points drawn on the mesh to measure how far its simplified form lies from it", minimum=1000
    )
