"""Parameters of the dense depth of a keyframe (Section 3.2)."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from threedfs.errors import UserError
from threedfs.params.field import parameter


@dataclass(frozen=True)
class DepthParams:
    """What a user may set about dense depth."""

    prior: str = parameter(
        "rotation_invariant",
        "smoothness prior: squared gradient, squared second derivatives, or these with the cross term",
        equation="Eq. 3",
        choices=("first_order", "second_order", "rotation_invariant"),
    )
    candidates: int = parameter(64, "discrete depths of the cost volume", symbol="l", minimum=8, maximum=512)
    spacing: str = parameter(
        "inverse",
        "how candidates are spaced: the paper's fifth power, uniform in inverse depth, or geometric",
        equation="Section 4.2",
        choices=("power", "inverse", "log"),
    )
    outside_step: float = parameter(
        4.0,
        "how many times longer steps between candidates are in front of and behind the object's box than inside it, "
        "where the box is known (paper: 1)",
        minimum=1.0,
    )
    patch_radius: int = parameter(
        0,
        "patches are (2 radius + 1)^2 pixels; 0 chooses 1 to 4 by the angle between neighbours (paper: 1)",
        unit="px",
        minimum=0,
        maximum=7,
    )
    variance_floor: float = parameter(
        2.0,
        "added to the variance of each patch: what noise alone would give (paper: none)",
        unit="grey levels^2",
        minimum=0,
    )
    missing_cost: float = parameter(
        0.5,
        "photometric error charged for a neighbour that does not see the patch",
        equation="Eq. 1",
        minimum=0,
        maximum=1,
    )
    iterations: int = parameter(8, "rounds of search and smoothing", minimum=1, maximum=33)
    fine_iterations: int = parameter(
        1,
        "last of these rounds at full resolution; those before it on 2x2 pixels put together",
        minimum=1,
    )
    photometric_weight: float = parameter(
        100.0, "weight of the photometric error in the search", symbol="lambda_c", equation="Eq. 6", exclusive_minimum=0
    )
    coupling: float = parameter(
        1.0,
        "coupling before the first iteration; smaller couples more",
        symbol="theta^(0)",
        equation="Eq. 10",
        exclusive_minimum=0,
    )
    coupling_decay: float = parameter(
        0.1,
        "how fast coupling tightens; decay times iterations must stay below 1",
        symbol="beta",
        equation="Eq. 10",
        minimum=0,
        maximum=1,
    )
    coupling_reading: str = parameter(
        "product",
        "how Eq. 10 is read: its factors multiply up, as printed, or it is one factor times the first coupling, which "
        "falls evenly and lets smoothing act",
        equation="Eq. 10",
        choices=("product", "linear"),
    )
    median_size: int = parameter(
        3, "side of the median filter after the search, 1 for none", unit="px", minimum=1, maximum=5
    )
    newton_rate: float = parameter(
        1.0,
        "learning rate of the Newton step after it (paper: 0.01)",
        symbol="eta",
        equation="Eq. 7",
        minimum=0,
        maximum=1,
    )
    measurement_weight: float = parameter(
        0.1,
        "weight of a measurement times its inverse-depth variance",
        symbol="lambda_m",
        equation="Section 3.2, item i",
        minimum=0,
    )
    stereo_deviation: float = parameter(
        0.02, "standard deviation of a stereo match's inverse depth, relative to it", exclusive_minimum=0
    )
    unmatched_trust: float = parameter(
        0.1,
        "factor of the trust in the photometric error where stereo found no match: such a minimum may be chance",
        minimum=0,
        maximum=1,
    )
    smoothness: float = parameter(
        1.0,
        "smoothness weight of the first iteration (paper: 0.01)",
        symbol="lambda_s^(0)",
        equation="Eq. 9",
        exclusive_minimum=0,
    )
    smoothness_growth: float = parameter(
        2.6, "its factor from one iteration to the next", symbol="gamma", equation="Eq. 9", minimum=1
    )
    edge_falloff: float = parameter(
        1.0, "how much an image edge weakens smoothing (paper: 5)", symbol="c_edge", equation="Eq. 9", minimum=0
    )
    object_pixels: float = parameter(
        380.0,
        "length of the object in the image at which smoothness and break_bending hold; a longer one is smoothed as "
        "much as if it were so long, per part of its length (paper: none)",
        unit="px",
        exclusive_minimum=0.0,
    )
    break_bending: float = parameter(
        0.003,
        "relative bend at which smoothing is halved, so that depth discontinuities open; 0 for never (paper)",
        unit="1/px^2",
        minimum=0,
    )
    confidence_falloff: float = parameter(
        15.0,
        "how fast trust falls with the least photometric error (paper: 5)",
        symbol="c_conf",
        equation="Eq. 11",
        minimum=0,
    )
    texture_half_variance: float = parameter(
        10.0,
        "patch variance at which trust is halved; 0 trusts flat patches as others (paper)",
        unit="grey levels^2",
        minimum=0,
    )
    tolerance: float = parameter(
        1e-6, "relative error, in energy norm, at which the last linear solve stops", exclusive_minimum=0, maximum=1e-2
    )
    early_tolerance: float = parameter(
        1e-4,
        "the same for the linear solves before it, whose surface is only searched around",
        exclusive_minimum=0,
        maximum=1e-2,
    )
    max_steps: int = parameter(200, "most steps of one linear solve", minimum=1)

    def __post_init__(self) -> None:
        """Refuse values that do not fit each other."""
        tightened = self.coupling_decay * self.iterations
        if tightened >= 1:
            raise UserError(
                "configuration, depth: expected coupling_decay * iterations below 1, or coupling reaches zero, got "
                f"{self.coupling_decay} * {self.iterations} = {tightened:.3g}."
            )
        if self.median_size % 2 == 0:
            raise UserError(f"configuration, depth.median_size: expected one of 1, 3, 5, got {self.median_size}.")


_MATCHING = (
    "candidates",
    "spacing",
    "outside_step",
    "patch_radius",
    "variance_floor",
    "missing_cost",
    "confidence_falloff",
    "texture_half_variance",
)
_WEIGHTS = ("object_pixels", "measurement_weight", "stereo_deviation", "unmatched_trust", "edge_falloff")


def matching_settings(params: DepthParams) -> dict[str, Any]:
    """Return the parameters that say how images are compared, as `gather_evidence` takes them."""
    return {name: getattr(params, name) for name in _MATCHING}


def solver_settings(params: DepthParams) -> dict[str, Any]:
    """Return the parameters that say how the surface is found, as `optimise_depth` takes them."""
    others = {*_MATCHING, *_WEIGHTS}
    return {field.name: getattr(params, field.name) for field in fields(params) if field.name not in others}
