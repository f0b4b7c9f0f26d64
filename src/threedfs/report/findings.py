"""What a user should know of a reconstruction before trusting it: each check with its margin and its advice."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One check.

    Attributes
    ----------
    what, value, expected : str
        What was looked at, what came, and what is good.
    good : bool
    advice : str
        What to do if it is not.
    """

    what: str
    value: str
    expected: str
    good: bool
    advice: str


@dataclass(frozen=True)
class Facts:
    """What the checks look at.

    Attributes
    ----------
    posed, frames : int
        Frames with a pose, and all.
    quality : mapping of str to float
        The figures of the poses.
    widest_gap : float
        Degrees around the object from which no camera looked.
    margin_used : float or None
        Share of the box's margin that the object takes up; above 1 it reaches out of the box.
    closed : bool
    pieces, genus : int
        Of the mesh.
    confirmed : float or None
        Share of the surface that photographs agree on.
    """

    posed: int
    frames: int
    quality: Mapping[str, float]
    widest_gap: float
    margin_used: float | None
    closed: bool
    pieces: int
    genus: int
    confirmed: float | None


_SLOWER = "film slower, in one take, with more of the surroundings in view"
_LEAST_POSED, _WIDEST_GAP, _LEAST_ANGLE, _LARGEST_ERROR, _LARGEST_STEP = 0.95, 75.0, 6.0, 1.0, 6.0
_LEAST_CONFIRMED, _MOST_HANDLES = 0.65, 12


def judge(facts: Facts) -> list[Finding]:
    """Return all checks of what is known, those that failed first.

    The limits are stricter than the gates that stop a run: what passes a gate by little is worth a look.
    """
    found = [check(facts) for check in _CHECKS]
    return sorted((finding for finding in found if finding is not None), key=lambda finding: finding.good)


def _check_placed(facts: Facts) -> Finding:
    return Finding(
        "frames placed",
        f"{facts.posed} of {facts.frames}",
        f"at least {_LEAST_POSED:.0%}",
        facts.posed / max(facts.frames, 1) >= _LEAST_POSED,
        f"Parts of the video could not be placed: {_SLOWER}.",
    )


def _check_gap(facts: Facts) -> Finding:
    return Finding(
        "widest side without a view",
        f"{facts.widest_gap:.0f} degrees",
        f"at most {_WIDEST_GAP:.0f}",
        facts.widest_gap <= _WIDEST_GAP,
        "The object was not filmed from there, so that side of the mesh is a guess: walk all the way around.",
    )


def _check_angle(facts: Facts) -> Finding | None:
    angle = facts.quality.get("triangulation_angle")
    if angle is None:
        return None
    return Finding(
        "angle between rays to a point",
        f"{angle:.1f} degrees",
        f"at least {_LEAST_ANGLE:.0f}",
        angle >= _LEAST_ANGLE,
        "The camera hardly moved around the object, so depth is uncertain: walk around it.",
    )


def _check_cameras(facts: Facts) -> Finding | None:
    error = facts.quality.get("reprojection_error")
    if error is None:
        return None
    return Finding(
        "error of the cameras",
        f"{error:.2f} pixels",
        f"at most {_LARGEST_ERROR:.1f}",
        error <= _LARGEST_ERROR,
        "Something moved, or the phone's stabilisation bent the picture: keep the scene still, turn it off.",
    )


def _check_step(facts: Facts) -> Finding | None:
    step = facts.quality.get("step_ratio")
    if step is None:
        return None
    return Finding(
        "largest step of the camera over its usual step",
        f"{step:.1f}",
        f"at most {_LARGEST_STEP:.0f}",
        step <= _LARGEST_STEP,
        f"The path may jump: {_SLOWER}.",
    )


def _check_box(facts: Facts) -> Finding | None:
    if facts.margin_used is None:
        return None
    return Finding(
        "room around the object in its box",
        f"{max(0.0, 1 - facts.margin_used):.0%} free",
        "more than 0 %",
        facts.margin_used < 1,
        "The object reaches the side of its box and may be cut off: raise locate.box_margin.",
    )


def _check_closed(facts: Facts) -> Finding:
    return Finding(
        "mesh",
        f"{'closed' if facts.closed else 'open'}, in {facts.pieces} piece{'s' * (facts.pieces != 1)}",
        "closed, in 1 piece",
        facts.closed and facts.pieces == 1,
        "A printer needs a closed mesh in one piece: repair it in a mesh editor, or use the method surface.",
    )


def _check_handles(facts: Facts) -> Finding:
    return Finding(
        "handles and tunnels",
        f"{facts.genus}",
        f"at most {_MOST_HANDLES}",
        facts.genus <= _MOST_HANDLES,
        "The surface is full of tunnels where depth is wrong; matt spray or talcum helps on shiny things.",
    )


def _check_confirmed(facts: Facts) -> Finding | None:
    if facts.confirmed is None:
        return None
    return Finding(
        "surface that photographs agree on",
        f"{facts.confirmed:.0%}",
        f"at least {_LEAST_CONFIRMED:.0%}",
        facts.confirmed >= _LEAST_CONFIRMED,
        "Bare or shiny faces: the shape there comes from outlines alone. Use soft light, or matt spray.",
    )


_CHECKS: tuple[Callable[[Facts], Finding | None], ...] = (
    _check_placed,
    _check_gap,
    _check_angle,
    _check_cameras,
    _check_step,
    _check_box,
    _check_closed,
    _check_handles,
    _check_confirmed,
)


def doubt_truth(sentences: list[str]) -> list[Finding]:
    """Return a failed check for each sentence that makes the truth doubtful."""
    advice = "Scores say nothing if the truth is of something else: give the truth of this sequence."
    return [Finding("truth", sentence, "that of this sequence", False, advice) for sentence in sentences]


def sum_up(findings: list[Finding]) -> str:
    """Return one sentence on the whole."""
    bad = [finding for finding in findings if not finding.good]
    if not bad:
        return "All checks passed."
    return f"{len(bad)} of {len(findings)} checks deserve a look: " + "; ".join(
        f"{finding.what} {finding.value}" for finding in bad
    )
