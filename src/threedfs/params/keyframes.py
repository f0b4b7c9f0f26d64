"""Parameters of the keyframes stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.errors import UserError
from threedfs.params.field import parameter


@dataclass(frozen=True)
class KeyframesParams:
    """How keyframes, their neighbours and their depth ranges are chosen."""

    distance_weight: float = parameter(
        16.0, "weight of (camera distance x mean inverse depth)^2 in the score of a frame", minimum=0.0
    )
    usage_weight: float = parameter(
        9.0,
        "weight of (1 - usage)^2, usage being the share of the last keyframe's points still in view",
        minimum=0.0,
    )
    new_keyframe_score: float = parameter(1.0, "score above which a viewing sector ends", exclusive_minimum=0.0)
    least_score_share: float = parameter(
        1.0,
        "share of `new_keyframe_score` down to which it is lowered while there are fewer sectors than `max_keyframes`; "
        "1 never lowers it",
        exclusive_minimum=0.0,
        maximum=1.0,
    )
    max_keyframes: int = parameter(
        24,
        "number of keyframes aimed at; with `keyframes_at_truth`, frames with a true mask are kept and count",
        minimum=2,
    )
    max_gap: float = parameter(
        30.0,
        "max_keyframes is exceeded while a viewing direction is farther than this from every keyframe",
        unit="degree",
        exclusive_minimum=0.0,
        maximum=180.0,
    )
    neighbours: int = parameter(10, "frames that a keyframe is matched against", minimum=1)
    min_neighbours: int = parameter(
        4, "neighbours taken whatever their angle and overlap, where there are so many frames", minimum=1
    )
    min_angle: float = parameter(
        2.0, "triangulation angle below which a neighbour loses worth", unit="degree", exclusive_minimum=0.0
    )
    max_angle: float = parameter(
        12.0, "triangulation angle above which a neighbour loses worth", unit="degree", exclusive_minimum=0.0
    )
    widest_angle: float = parameter(
        35.0, "triangulation angle beyond which a frame is no neighbour", unit="degree", exclusive_minimum=0.0
    )
    min_overlap: float = parameter(
        0.3,
        "share of the keyframe's points in view of a frame below which it is no neighbour",
        minimum=0.0,
        maximum=1.0,
    )
    min_shared: int = parameter(
        5,
        "points triangulated from both, below which a frame is no neighbour: two passes of a long path drift apart",
        minimum=0,
    )
    stereo_angle: float = parameter(
        18.0,
        "median angle to the neighbours from which depth is anchored by stereo matches (paper: never, 180)",
        unit="degree",
        minimum=0.0,
        maximum=180.0,
    )
    near_factor: float = parameter(
        0.55,
        "near end of the depth range over the 1st percentile of the sparse depths",
        exclusive_minimum=0.0,
    )
    far_factor: float = parameter(
        1.2, "far end of the depth range over the 97th percentile of the sparse depths", exclusive_minimum=0.0
    )

    def __post_init__(self) -> None:
        """Refuse values that do not fit each other."""
        if not self.min_angle <= self.max_angle <= self.widest_angle:
            raise UserError(
                "configuration, keyframes: expected min_angle <= max_angle <= widest_angle, got "
                f"{self.min_angle}, {self.max_angle} and {self.widest_angle}."
            )
        if self.min_neighbours > self.neighbours:
            raise UserError(
                "configuration, keyframes: expected min_neighbours <= neighbours, got "
                f"{self.min_neighbours} and {self.neighbours}."
            )
        if self.near_factor >= self.far_factor:
            raise UserError(
                "configuration, keyframes: expected near_factor < far_factor, got "
                f"{self.near_factor} and {self.far_factor}."
            )
