"""Parameters of the scale stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class ScaleParams:
    """How a tag or a board of known size is looked for in the frames; only where a sequence names one."""

    min_frames: int = parameter(3, "fewest frames that must see the tag or the whole board", minimum=2)
    max_spread: float = parameter(
        0.03,
        "largest disagreement of the distances on the tag or the board, as a share of the scale",
        exclusive_minimum=0.0,
    )
    window: int = parameter(
        5, "half side of the window in which a corner or an edge is refined", unit="pixel", minimum=2
    )
