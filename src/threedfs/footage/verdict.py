"""Whether a film can be used, and what to do better: limits, and sentences for people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.footage.look import Look
from threedfs.footage.motion import Step, sweep_angle

GOOD, FAIR, BAD = "good", "fair", "bad"
_SHORTEST, _SHORT = 1.5, 5.0  # seconds
_FEWEST_FRAMES, _FEW_PHOTOS = 8, 20
_BLURRED, _SOFT = 0.10, 0.20
_BLACK, _DIM = 25, 50  # median grey levels
_CLIPPED, _MUCH_CLIPPED = 0.15, 0.40
_BARE, _PLAIN = 80, 250  # keypoints
_LOST, _LOOSE = 0.5, 0.1  # shares of steps that cannot be matched
_STILL = 0.01  # of the longer side, from one look to the next
_FLAT = 0.0015
_NARROW, _WHOLE = 25.0, 200.0  # degrees


@dataclass(frozen=True)
class Opinion:
    """One thing that was looked at.

    Attributes
    ----------
    what, value : str
    grade : str
        `GOOD`, `FAIR` or `BAD`.
    advice : str
        What to do if it is not good.
    """

    what: str
    value: str
    grade: str
    advice: str = ""


def judge_film(looks: Sequence[Look], steps: Sequence[Step], *, seconds: float | None, frames: int) -> list[Opinion]:
    """Judge frames that were looked at, at even distances, and the steps between them.

    Parameters
    ----------
    looks : sequence of Look
    steps : sequence of Step
        One fewer.
    seconds : float or None
        Length of a video; None for photos.
    frames : int
        All that the source holds.
    """
    opinions = [_judge_length(seconds, frames)]
    if looks:
        opinions += [_judge_sharpness(looks), _judge_light(looks), _judge_texture(looks)]
    if steps:
        opinions += _judge_motion(steps, seconds is not None)
    return opinions


def conclude(opinions: Sequence[Opinion]) -> str:
    """Return the verdict in one sentence."""
    bad = [opinion.what for opinion in opinions if opinion.grade == BAD]
    fair = [opinion.what for opinion in opinions if opinion.grade == FAIR]
    if bad:
        return f"It cannot be used as it is: {', '.join(bad)}."
    if fair:
        return f"It can be used, and would be better with more care for: {', '.join(fair)}."
    return "It can be used."


def _grade(bad: bool, fair: bool) -> str:
    return BAD if bad else FAIR if fair else GOOD


def _judge_length(seconds: float | None, frames: int) -> Opinion:
    if seconds is None:
        grade = _grade(frames < _FEWEST_FRAMES, frames < _FEW_PHOTOS)
        return Opinion("photos", f"{frames}", grade, "Take 50 to 100 photos, all around at two or three heights.")
    grade = _grade(frames < _FEWEST_FRAMES or seconds < _SHORTEST, seconds < _SHORT)
    return Opinion("length", f"{seconds:.1f} s, {frames} frames", grade, "Film for 10 to 30 seconds, once around.")


def _judge_sharpness(looks: Sequence[Look]) -> Opinion:
    # blur of single frames does no harm, as the sharpest are taken: the upper third counts
    value = float(np.percentile([look.sharpness for look in looks], 67))
    advice = "Move more slowly, in better light; lock the focus on the object and clean the lens."
    return Opinion("sharpness", f"{value:.2f}", _grade(value < _BLURRED, value < _SOFT), advice)


def _judge_light(looks: Sequence[Look]) -> Opinion:
    level = float(np.median([look.level for look in looks]))
    clipped = float(np.median([look.clipped for look in looks]))
    value = f"median level {level:.0f} of 255, {clipped:.0%} clipped white"
    if level < _DIM:
        return Opinion("light", value, _grade(level < _BLACK, True), "Too dark: film in even, bright light.")
    advice = "Overexposed: lock the exposure on the object, or take out direct sun."
    return Opinion("light", value, _grade(clipped > _MUCH_CLIPPED, clipped > _CLIPPED), advice)


def _judge_texture(looks: Sequence[Look]) -> Opinion:
    count = float(np.median([len(look.pixels) for look in looks]))
    advice = "Lay something with texture, as a newspaper, beside the object and keep it in view."
    return Opinion("texture", f"{count:.0f} features a frame", _grade(count < _BARE, count < _PLAIN), advice)


def _judge_motion(steps: Sequence[Step], video: bool) -> list[Opinion]:
    known = [step for step in steps if step.rotation is not None]
    lost = 1 - len(known) / len(steps)
    if video:
        advice = "Neighbouring frames show too little in common: film slower, keep the same scene in view and in focus."
    else:
        advice = "Neighbouring photos show too little in common: take more of them, nearer to each other and in focus."
    # photos need not be sorted by place
    worst = BAD if video else FAIR
    opinions = [
        Opinion(
            "connection",
            f"{len(known)} of {len(steps)} steps can be matched",
            worst if lost > _LOST else _grade(False, lost > _LOOSE),
            advice,
        )
    ]
    if not known:
        return opinions
    shift = float(np.median([step.shift for step in known]))
    parallax = float(np.percentile([step.parallax for step in known], 75))
    angle = sweep_angle([step.rotation for step in steps])
    if shift < _STILL and angle < _NARROW:
        return [*opinions, Opinion("motion", "the camera hardly moves", BAD, "Walk around the object while you film.")]
    opinions.append(
        Opinion(
            "parallax",
            f"{100 * parallax:.2f} % of the picture a step",
            _grade(parallax < _FLAT / 3, parallax < _FLAT),
            "The camera seems only to turn: walk around the object, do not stand still and pan.",
        )
    )
    if lost <= _LOST:
        opinions.append(
            Opinion(
                "way around",
                f"about {min(angle, 999):.0f} degrees" + (" of 360" if angle < 360 else ""),
                _grade(angle < _NARROW, angle < _WHOLE),
                "Walk all the way around: sides that were not filmed are a guess.",
            )
        )
    return opinions
