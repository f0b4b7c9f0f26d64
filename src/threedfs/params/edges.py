"""Parameters of the edges stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class EdgesParams:
    """How contour strength is measured."""

    method: str = parameter(
        "multiscale_gradient",
        "the detector: colour gradients, to which all other parameters belong, or learned contours",
        choices=("multiscale_gradient", "structured"),
    )
    scales: tuple[float, ...] = parameter(
        (1.0, 2.0, 4.0),
        "standard deviations of the smoothing before each gradient",
        unit="px",
        exclusive_minimum=0.0,
    )
    full_strength_percentile: float = parameter(
        98.0,
        "percentile of the image's gradients that becomes strength 1",
        unit="%",
        exclusive_minimum=0.0,
        maximum=100.0,
    )
    min_full_strength: float = parameter(
        2.0,
        "gradient that becomes strength 1 at least, so that noise in a blank image is no contour",
        unit="Lab unit / px",
        exclusive_minimum=0.0,
    )
