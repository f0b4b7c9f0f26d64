"""Parameters of the depth_experiment stage (Section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class DepthExperimentParams:
    """Who takes part in the depth experiment and how it is scored."""

    sequences: tuple[str, ...] = parameter(
        (), "sequences that take part; they need given cameras, truth.cameras and truth.depth"
    )
    keyframes: int = parameter(
        5,
        "keyframes of each sequence, spread evenly over those with a true depth image",
        equation="Section 4.2",
        minimum=1,
    )
    bin_width: float = parameter(
        0.1,
        "error is also given for intervals of the true depth of this width",
        unit="unit of the true cameras",
        exclusive_minimum=0.0,
    )
