"""Parameters of the depth_trial stage: one keyframe of the depth experiment (Section 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.field import parameter


@dataclass(frozen=True)
class DepthTrialParams:
    """What is given to the depth maps of a keyframe in the depth experiment.

    All else is as under depth, without stereo and without `depth.object_pixels`: the trial is of the whole frame.
    """

    measurements: tuple[int, ...] = parameter(
        (100, 1000),
        "numbers of depths drawn from the ground truth and given as measured",
        unit="px",
        equation="Section 4.2",
        minimum=4,
    )
    measurement_deviation: float = parameter(
        0.01,
        "standard deviation of the inverse depth that a drawn measurement is credited with; its weight is "
        "depth.measurement_weight over the square",
        unit="1 / scene unit",
        equation="Section 3.2, item i",
        exclusive_minimum=0.0,
    )
