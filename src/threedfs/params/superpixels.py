"""Parameters of the superpixels stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SuperpixelsParams:
    """How a keyframe is split into superpixels."""

    count: int = parameter(
        6000, "superpixels of an image, about (paper: 2000)", equation="Sec. 3.4", minimum=10, maximum=100000
    )
    compactness: float = parameter(
        10.0,
        "colour difference that weighs as much as the distance between two superpixels",
        unit="Lab unit",
        exclusive_minimum=0.0,
    )
