"""A desk stapler, 0.14 long: dark glossy plastic without texture, bare steel, one small label."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import Field, box, cylinder, intersection, place, subtract, union
from threedfs.synthetic.solid import Material, Part, Solid, build_solid
from threedfs.synthetic.sweeps import prism, spline
from threedfs.synthetic.textures import lettered, plain

# The arm turns about the hinge, a line along x; arm coordinates have their origin there.
_HINGE, _LIFT = np.array((0.0, 0.050, 0.0235)), 4.6  # degrees
_HALF_WIDTH = 0.0155
_PIECES = 30  # of an outline between two knots: highlights show every corner


def make_stapler(spacing: float = 0.0009, seed: int = 70) -> Solid:
    """Make the stapler: it stands on z = 0 around the origin, its mouth towards -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. The mouth is 0.006 to 0.013 open.
    seed : int
        Seed of its textures.
    """
    gloss = Material(plain((0.016, 0.020, 0.034), 0.04, 0.02, seed), 0.45, 160, 0.045)
    matt = Material(plain((0.026, 0.027, 0.030), 0.10, 0.004, seed + 10), 0.15, 40, 0.02)
    steel = Material(plain((0.26, 0.26, 0.27), 0.06, 0.005, seed + 20), 0.5, 120, 0.40)
    paper = plain((0.66, 0.64, 0.58), 0.08, 0.004, seed + 30)
    side = _arm_slope() @ (0, 0, 1)
    middle = _HINGE + _arm_slope() @ (_HALF_WIDTH, -0.058, 0.0065)
    label = Material(
        lettered(paper, (0.45, 0.03, 0.03), ["TACKER", "24/6"], 0.0036, middle, _arm_slope() @ (0, 1, 0), side),
        0.10,
        40,
    )
    parts = [
        Part(_base(), matt),
        Part(_anvil(), steel),
        Part(_on_arm(_arm()), gloss),
        Part(_on_arm(_magazine()), steel),
        Part(_pin(), steel),
        Part(_on_arm(box((_HALF_WIDTH - 0.0008, -0.058, 0.0065), (0.0011, 0.0160, 0.0065), 0.0006)), label),
    ]
    return build_solid(parts, (-0.022, -0.074, 0.0), (0.022, 0.074, 0.055), spacing)


def _arm_slope() -> np.ndarray:
    cosine, sine = np.cos(np.radians(_LIFT)), np.sin(np.radians(_LIFT))
    return np.array([[1, 0, 0], [0, cosine, sine], [0, -sine, cosine]])


def _on_arm(field: Field) -> Field:
    return place(field, _HINGE, _arm_slope())


def _arm() -> Field:
    side = spline(
        [
            (0.017, -0.004),
            (0.017, 0.006),
            (0.006, 0.0140),
            (-0.030, 0.0185),
            (-0.070, 0.0195),
            (-0.104, 0.0155),
            (-0.1175, 0.0060),
            (-0.1165, -0.0030),
            (-0.100, -0.0050),
            (-0.050, -0.0050),
            (0.004, -0.0060),
        ],
        _PIECES,
        closed=True,
    )
    above = _both_sides([(0.0155, 0.014), (0.0157, -0.030), (0.0150, -0.080), (0.0125, -0.108), (0.0060, -0.1185)])
    return intersection(
        prism(side, -_HALF_WIDTH, _HALF_WIDTH, axis=0, rounding=0.0055), prism(above, -0.02, 0.03, rounding=0.001)
    )


def _both_sides(right: list[tuple[float, float]]) -> np.ndarray:
    """Return the smooth outline, seen from above, whose right half goes through points (x, y) from back to front."""
    return spline([*right, *((-x, y) for x, y in right[::-1])], _PIECES, closed=True)


def _magazine() -> Field:
    rail = box((0, -0.056, -0.0080), (0.0068, 0.0600, 0.0042), 0.0009)
    face = box((0, -0.1170, -0.0030), (0.0080, 0.0028, 0.0090), 0.0010)
    return union(rail, face)


def _base() -> Field:
    plan = _both_sides(
        [(0.0120, 0.0695), (0.0185, 0.062), (0.0190, 0.030), (0.0165, -0.010), (0.0185, -0.052), (0.0145, -0.068)]
    )
    plate = prism(plan, -0.02, 0.0065, rounding=0.0020)
    yoke = [(0.024, 0.004), (0.036, 0.018), (0.046, 0.0300), (0.056, 0.0305), (0.065, 0.022), (0.067, 0.004)]
    return union(plate, prism(spline(yoke, _PIECES, closed=True), -0.0185, 0.0185, axis=0, rounding=0.0015))


def _anvil() -> Field:
    pad = box((0, -0.056, 0.0068), (0.0105, 0.0095, 0.0022), 0.0008)
    grooves = [box((x, -0.0610, 0.0090), (0.0030, 0.0016, 0.0010)) for x in (-0.0050, 0.0050)]
    return subtract(pad, *grooves)


def _pin() -> Field:
    x = np.array((0.0205, 0, 0))
    return cylinder(_HINGE - x, _HINGE + x, 0.0036, 0.0008)
