"""Parameters of the mesh's smoothing, which two stages have."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SmoothingSettings:
    """How a mesh is smoothed."""

    smoothing_steps: int = parameter(3, "steps of the mesh's smoothing", equation="Sec. 3.5", minimum=0, maximum=100)
    smoothing_contrast: float = parameter(
        0.5,
        "bend of the surface at a vertex from which it is kept as an edge",
        unit="mean edge",
        equation="Sec. 3.5",
        exclusive_minimum=0.0,
    )
