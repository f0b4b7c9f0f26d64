"""Parameters of the crops stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class CropsParams:
    """What part of the source's frames is looked at closely, and how finely."""

    whole: bool = parameter(
        False,
        "take whole frames, as where no object is, with the depth range of `keyframes`; crops.longest_side limits them",
    )
    longest_side: int = parameter(
        960, "longer side of a frame that is taken whole; smaller sources keep their size", unit="pixel", minimum=64
    )
    pixels: int = parameter(
        400_000, "mean area of the crops; a small object in a small source has fewer", unit="pixel", minimum=10_000
    )
    margin: float = parameter(
        0.2,
        "what a crop exceeds the projection of the object's box by on each side",
        unit="longer side of the projection",
        minimum=0.0,
        maximum=1.0,
    )
    near_factor: float = parameter(
        0.6,
        "near end of the depth range over the nearest corner of the box; bare faces lean to the middle of the range",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    far_factor: float = parameter(
        1.2, "far end over the 97th percentile of the sparse depths in the crop, or the box's farthest", minimum=1.0
    )
