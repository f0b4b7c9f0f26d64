"""Parameters of the frames stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class FramesParams:
    """Which frames of the source are worked on, and at what resolution."""

    longest_side: int = parameter(
        960, "longer side of the working frames; smaller sources keep their size", unit="pixel", minimum=64
    )
    max_frames: int = parameter(
        150, "most frames taken at uniform steps; with `keyframes_at_truth`, those with a true mask as well", minimum=2
    )
    min_frames: int = parameter(8, "fewest usable frames to go on with", minimum=2)
    blank_contrast: float = parameter(
        2.0,
        "standard deviation of grey below which a frame is blank and left out",
        unit="grey level",
        minimum=0.0,
    )
