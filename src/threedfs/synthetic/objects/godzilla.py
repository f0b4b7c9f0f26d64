"""A standing monster, 0.2 high: jagged plates down its back, open jaws, a heavy tail that lies on the table."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from threedfs.synthetic.fields import (
    Field,
    displace,
    ellipsoid,
    mirror_x,
    offset,
    place,
    round_cone,
    smooth_union,
    sphere,
)
from threedfs.synthetic.noise import cell_noise, fractal_noise
from threedfs.synthetic.solid import Material, Part, Solid, build_solid
from threedfs.synthetic.sweeps import prism, round_cones, spline, tube
from threedfs.synthetic.textures import plain, scaly, speckled, streaked

# From the skull down the back to the tip of the tail: x, y, z and radius.
_SPINE = np.array(
    [
        (0, -0.042, 0.181, 0.0135),
        (0, -0.034, 0.166, 0.0160),
        (0, -0.027, 0.148, 0.0205),
        (0, -0.022, 0.126, 0.0275),
        (0, -0.016, 0.100, 0.0325),
        (0, -0.008, 0.074, 0.0345),
        (0, 0.012, 0.048, 0.0310),
        (0, 0.036, 0.028, 0.0240),
        (0, 0.058, 0.0165, 0.0180),
        (-0.010, 0.080, 0.0115, 0.0135),
        (-0.032, 0.096, 0.0085, 0.0105),
        (-0.060, 0.094, 0.0068, 0.0083),
        (-0.080, 0.076, 0.0055, 0.0066),
        (-0.086, 0.052, 0.0045, 0.0052),
    ]
)
# Knots of the spine between which its plates lie in one plane.
_FLAT = slice(0, 9)
# A plate like a maple leaf: along its foot and outward, in units of about half its width and of its height.
_LEAF = np.array(
    [
        (-0.80, 0.00),
        (-1.00, 0.36),
        (-0.66, 0.40),
        (-0.72, 0.72),
        (-0.34, 0.68),
        (0.05, 1.00),
        (0.30, 0.62),
        (0.74, 0.60),
        (0.60, 0.34),
        (0.95, 0.24),
        (0.80, 0.00),
    ]
)


def make_godzilla(spacing: float = 0.0016, seed: int = 53) -> Solid:
    """Make the monster: it stands on z = 0 around the origin and faces -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. Its thinnest parts are 0.004 thick.
    seed : int
        Seed of its textures.
    """
    hide = Material(scaly((0.165, 0.185, 0.135), (0.020, 0.026, 0.022), 0.0038, seed), 0.06, 25)
    bone = Material(speckled((0.42, 0.41, 0.34), (0.15, 0.16, 0.13), 0.0016, 0.45, seed + 30), 0.08, 30)
    claw = Material(speckled((0.46, 0.41, 0.32), (0.24, 0.20, 0.14), 0.0018, 0.4, seed + 60), 0.2, 60)
    mouth = Material(streaked((0.36, 0.05, 0.045), (0.17, 0.015, 0.02), 0.0030, 0.0030, seed + 90), 0.15, 50)
    eye = Material(plain((0.75, 0.45, 0.05), 0.1, 0.003, seed + 120), 0.5, 120, 0.04)
    parts = [
        Part(_body(seed), hide),
        Part(_middle_plates(), bone),
        Part(_side_plates(), bone),
        Part(_tail_spikes(), bone),
        Part(_claws(), claw),
        Part(_teeth(), claw),
        Part(_mouth(), mouth),
        Part(_eyes(), eye),
    ]
    return build_solid(parts, (-0.098, -0.094, 0.0), (0.062, 0.112, 0.212), spacing)


def _body(seed: int) -> Field:
    trunk = tube(_SPINE[:, :3], _SPINE[:, 3])
    chest = ellipsoid((0, -0.034, 0.1180), (0.0270, 0.0230, 0.0240))
    belly = ellipsoid((0, -0.024, 0.0820), (0.0310, 0.0290, 0.0300))
    body = smooth_union(0.012, trunk, chest, belly, mirror_x(_leg()), mirror_x(_arm()))

    def wrinkles(points: np.ndarray) -> np.ndarray:
        first, second, _ = cell_noise(points, 0.0038, seed)
        scales = 0.0004 * np.clip((second - first) / 0.3, 0, 1)
        return scales + 0.0011 * fractal_noise(points / (0.009, 0.009, 0.020), 0.0, 1.0, 2, 0.5, seed + 10)

    return displace(smooth_union(0.005, body, _head()), wrinkles)


def _leg() -> Field:
    thigh = ellipsoid((0.0290, -0.010, 0.0500), (0.0210, 0.0270, 0.0330))
    shin = tube([(0.0330, -0.012, 0.042), (0.0355, -0.006, 0.022), (0.0355, -0.012, 0.009)], (0.0200, 0.0165, 0.0155))
    foot = ellipsoid((0.0360, -0.024, 0.0055), (0.0180, 0.0230, 0.0120))
    toes = round_cones(
        ((0.0360 + 0.6 * side, -0.032, 0.006), (0.0360 + side, -0.044 + 0.3 * abs(side), 0.0050), 0.0075, 0.0058)
        for side in (-0.0125, 0.0, 0.0125)
    )
    return smooth_union(0.006, thigh, shin, foot, toes)


def _arm() -> Field:
    limb = tube(
        [(0.0240, -0.026, 0.1290), (0.0400, -0.036, 0.1150), (0.0420, -0.056, 0.1030), (0.0390, -0.067, 0.1050)],
        (0.0140, 0.0110, 0.0080, 0.0072),
    )
    return smooth_union(0.006, limb, sphere((0.0280, -0.024, 0.1290), 0.0140))


def _claws() -> Field:
    cones = [
        ((0.0360 + side, -0.046 + 0.3 * abs(side), 0.0055), (0.0360 + 1.15 * side, -0.0555 + 0.4 * abs(side), 0.0028))
        for side in (-0.0125, 0.0, 0.0125)
    ]
    x, y, z = 0.0390, -0.0690, 0.1050  # the hand
    cones += [
        ((x + side, y, z + 0.5 * abs(side)), (x + 1.9 * side, y - 0.0110, z - 0.0075))
        for side in (-0.0055, 0.0, 0.0055)
    ]
    cones.append(((x - 0.0050, y + 0.0030, z), (x - 0.0115, y - 0.0040, z + 0.0030)))
    return mirror_x(round_cones((a, b, 0.0034, 0.0021) for a, b in cones))


def _head() -> Field:
    skull = ellipsoid((0, -0.050, 0.1860), (0.0160, 0.0190, 0.0140))
    snout = tube([(0, -0.058, 0.1860), (0, -0.074, 0.1840), (0, -0.0835, 0.1820)], (0.0125, 0.0105, 0.0085))
    jaw = tube([(0, -0.046, 0.1715), (0, -0.061, 0.1605), (0, -0.0735, 0.1535)], (0.0115, 0.0085, 0.0064))
    brows = mirror_x(round_cone((0.0095, -0.046, 0.1970), (0.0105, -0.066, 0.1925), 0.0048, 0.0034))
    nostrils = mirror_x(sphere((0.0045, -0.0870, 0.1870), 0.0040))
    cheeks = mirror_x(sphere((0.0125, -0.047, 0.1760), 0.0085))
    return smooth_union(0.004, skull, snout, jaw, brows, nostrils, cheeks)


def _eyes() -> Field:
    return mirror_x(sphere((0.0122, -0.0620, 0.1885), 0.0036))


def _mouth() -> Field:
    """The gullet, and the tongue between the jaws."""
    return tube([(0, -0.054, 0.1735), (0, -0.065, 0.1670), (0, -0.0745, 0.1625)], (0.0090, 0.0048, 0.0034))


def _teeth() -> Field:
    """Stand teeth along the rims of both jaws."""
    cones = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        x, y, z = 0.0094 - 0.0056 * share**3, -0.065 - 0.0225 * share, 0.1775 - 0.0010 * share
        cones.append(((x, y, z), (x, y, z - 0.0030)))
    for share in (0.0, 0.33, 0.66, 1.0):
        x, y, z = 0.0076 - 0.0044 * share**3, -0.0600 - 0.0155 * share, 0.1660 - 0.0085 * share
        cones.append(((x, y, z), (x, y - 0.0010, z + 0.0032)))
    return mirror_x(round_cones((a, b, 0.0024, 0.0019) for a, b in cones))


def _row(width: np.ndarray, sink: float) -> np.ndarray:
    """Draw one outline (N, 2), in (y, z), around a row of plates along the flat part of the spine.

    Parameters
    ----------
    width : (M,) float64
        Of each plate along the spine; it is a third higher than wide.
    sink : float
        How deep the feet of the plates are in the body, as a share of its radius.
    """
    curve = spline(_SPINE[_FLAT], 24)
    step = np.linalg.norm(np.diff(curve[:, :3], axis=0), axis=1)
    length = np.append(0, np.cumsum(step))
    # Plates follow each other closely; what is left of the spine is shared among the gaps.
    gap = (length[-1] - width.sum()) / len(width)
    middle = np.cumsum(width) - width / 2 + gap * (np.arange(len(width)) + 0.5)
    outer, inner = [], []
    for centre, size in zip(middle, width, strict=True):
        foot = [np.interp(centre, length, curve[:, k]) for k in (1, 2, 3)]
        ahead = [np.interp(centre + 0.004, length, curve[:, k]) for k in (1, 2)]
        along = np.array(ahead) - foot[:2]
        along /= np.linalg.norm(along)
        out = np.array((-along[1], along[0]))  # the way is downward: the back lies to its left
        root = np.array(foot[:2]) + (1 - sink) * foot[2] * out
        tall = 1.35 * size + sink * foot[2]
        outer += [root + 0.44 * size * u * along + tall * v * out for u, v in _LEAF]
        inner.append(np.array(foot[:2]))
    return np.array(outer + inner[::-1])


def _plates(width: np.ndarray, sink: float) -> Field:
    """Make a row of plates in the plane x = 0; all rims and tips are round, so that none is thinner than the plate."""
    return offset(prism(_row(width, sink), -0.0003, 0.0003, axis=0), 0.0019)


def _middle_plates() -> Field:
    width = np.array((0.0085, 0.0120, 0.0165, 0.0230, 0.0280, 0.0270, 0.0220, 0.0160, 0.0115))
    return _plates(width, 0.15)


def _side_plates() -> Field:
    width = np.array((0.0060, 0.0080, 0.0110, 0.0140, 0.0150, 0.0150, 0.0130, 0.0100, 0.0080))
    turn = np.radians(24)
    yaw = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return mirror_x(place(_plates(width, 0.35), (0.0110, 0.0, 0.0), yaw))


def _tail_spikes() -> Field:
    """Set spikes on top of the tail, smaller and smaller."""
    ridge = spline(_SPINE[8:], 3)[1:-1]
    up = np.array([0.0, 0.0, 1.0])
    cones = []
    for here, after in pairwise(ridge):
        along = (after - here)[:3] / np.linalg.norm((after - here)[:3])
        foot = here[:3] + (here[3] - 0.001) * up
        cones.append((foot, foot + (0.002 + 0.45 * here[3]) * up + 0.003 * along, 0.0034, 0.0021))
    return round_cones(cones)
