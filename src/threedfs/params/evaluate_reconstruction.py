"""Parameters of the evaluate_reconstruction stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class EvaluateReconstructionParams:
    """How poses and depth maps are scored."""

    silhouette_erosion: int = parameter(
        2, "border taken off the true object before depths are compared on it", unit="px", minimum=0, maximum=100
    )
