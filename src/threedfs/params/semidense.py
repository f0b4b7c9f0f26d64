"""Parameters of the semidense stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class SemidenseParams:
    """How semi-dense inverse depth is searched, fused and cleaned."""

    min_gradient: float = parameter(
        5.0,
        "least gradient, maximum over 3x3, of a pixel that is searched",
        unit="grey level / px",
        minimum=0.0,
    )
    min_gradient_cosine2: float = parameter(
        0.09,
        "least squared cosine between gradient and epipolar line",
        minimum=0.0,
        maximum=1.0,
    )
    prior_radius: float = parameter(
        0.05,
        "how far a sparse point tells the depth of its surroundings, over the longest side of the image",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    prior_spread: float = parameter(
        0.05,
        "least standard deviation of the inverse depth that sparse points give, as a share of it",
        exclusive_minimum=0.0,
    )
    image_noise: float = parameter(
        4.0,
        "standard deviation of intensity between two views of a surface",
        unit="grey level",
        exclusive_minimum=0.0,
    )
    line_noise: float = parameter(
        0.5, "standard deviation of the epipolar line's position", unit="px", exclusive_minimum=0.0
    )
    max_residual: float = parameter(
        12.0, "greatest root mean square difference of a match", unit="grey level", exclusive_minimum=0.0
    )
    distinctness: float = parameter(
        1.5,
        "how many times the difference of the second best place must exceed that of the best",
        minimum=1.0,
    )
    rival_margin: float = parameter(
        0.5,
        "part of the difference that noise makes at the true place by which every rival must exceed the best place",
        minimum=0.0,
    )
    consistency: float = parameter(
        1.0,
        "greatest difference of two inverse depths that agree, in standard deviations of that difference",
        exclusive_minimum=0.0,
    )
    min_support: int = parameter(
        3, "least number of neighbours that agree on a depth; half of the neighbours, where those are fewer", minimum=1
    )
    min_agreement: float = parameter(
        0.5,
        "least share of agreeing neighbours among those in which the pixel could be searched",
        minimum=0.0,
        maximum=1.0,
    )
    smoothing: float = parameter(
        0.075,
        "standard deviation of inverse depth that one pixel of distance adds in the 5x5 regularisation",
        unit="1 / scene unit / px",
        exclusive_minimum=0.0,
    )
    min_neighbourhood: int = parameter(
        2, "least number of agreeing points in the 5x5 pixels around a point", minimum=0, maximum=24
    )
