"""Parameters of the superpixels stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SuperpixelsParams:
    """How a keyframe is split into superpixels."""

    area: float = parameter(
        50.0, "mean area of a superpixel (paper: 2000 in an image)", unit="pixel", equation="Sec. 3.4", minimum=4.0
    )
    compactness: float = parameter(
        10.0,
        "colour difference that weighs as much as the distance between two superpixels",
        unit="Lab unit",
        exclusive_minimum=0.0,
    )
