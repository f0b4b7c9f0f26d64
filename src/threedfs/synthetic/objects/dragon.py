"""A dragon statuette, 0.2 high: it sits with folded wings, its tail curled around its feet."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import (
    Field,
    displace,
    ellipsoid,
    mirror_x,
    place,
    round_cone,
    smooth_union,
    sphere,
    union,
)
from threedfs.synthetic.noise import cell_noise
from threedfs.synthetic.solid import Material, Part, Solid, build_solid
from threedfs.synthetic.sweeps import prism, round_cones, spline, tube
from threedfs.synthetic.textures import plain, scaly, speckled, streaked

# From the haunches up the back and neck to the skull: x, y, z and radius.
_SPINE = np.array(
    [
        (0, 0.042, 0.026, 0.024),
        (0, 0.024, 0.046, 0.034),
        (0, 0.004, 0.076, 0.030),
        (0, -0.006, 0.104, 0.025),
        (0, 0.002, 0.128, 0.0165),
        (0, 0.008, 0.148, 0.0130),
        (0, -0.002, 0.168, 0.0118),
        (0, -0.022, 0.176, 0.0120),
    ]
)
_TAIL = np.array(
    [
        (0, 0.040, 0.022, 0.022),
        (0.020, 0.066, 0.013, 0.0145),
        (0.056, 0.066, 0.009, 0.0110),
        (0.080, 0.034, 0.0075, 0.0090),
        (0.078, -0.010, 0.0065, 0.0074),
        (0.056, -0.044, 0.0055, 0.0062),
        (0.024, -0.062, 0.0050, 0.0052),
        (-0.008, -0.066, 0.0048, 0.0046),
    ]
)
# Where the paws stand, and how far toes lie beside their middle.
_HIND_PAW, _FORE_PAW = (0.041, -0.030), (0.021, -0.044)
_TOES = (-0.009, 0.0, 0.009)
# A folded wing seen from its side, in (y, z): shoulder, wrist, finger tips, and where it meets the flank.
_SHOULDER, _WRIST = np.array((0.000, 0.104)), np.array((0.022, 0.150))
_WING_TIPS = np.array([(0.036, 0.170), (0.074, 0.118), (0.082, 0.072), (0.064, 0.040)])
_FLANK = np.array((0.012, 0.068))


def make_dragon(spacing: float = 0.0016, seed: int = 40) -> Solid:
    """Make the dragon: it sits on z = 0 around the origin and faces -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. Its thinnest parts are 0.004 thick.
    seed : int
        Seed of its textures.
    """
    skin = Material(scaly((0.085, 0.24, 0.08), (0.014, 0.042, 0.024), 0.0042, seed), 0.10, 30)
    belly = Material(streaked((0.62, 0.43, 0.16), (0.36, 0.21, 0.06), 0.006, 0.0022, seed + 20), 0.10, 30)
    membrane = Material(speckled((0.36, 0.045, 0.03), (0.17, 0.02, 0.018), 0.0026, 0.45, seed + 30), 0.08, 25)
    horn = Material(speckled((0.66, 0.55, 0.36), (0.33, 0.23, 0.11), 0.0018, 0.4, seed + 90), 0.15, 40)
    eye = Material(plain((0.75, 0.42, 0.02), 0.1, 0.004, seed + 150), 0.5, 120, 0.04)
    mouth = Material(speckled((0.30, 0.03, 0.03), (0.14, 0.01, 0.012), 0.002, 0.5, seed + 160), 0.1, 40)
    parts = [
        Part(_body(seed), skin),
        Part(_belly(), belly),
        Part(_membranes(), membrane),
        Part(_wing_bones(), skin),
        Part(_horns(), horn),
        Part(_spikes(), horn),
        Part(_claws(), horn),
        Part(_eyes(), eye),
        Part(_mouth(), mouth),
    ]
    return build_solid(parts, (-0.095, -0.085, 0.0), (0.1, 0.1, 0.22), spacing)


def _body(seed: int) -> Field:
    spine = tube(_SPINE[:, :3], _SPINE[:, 3])
    tail = tube(_TAIL[:, :3], _TAIL[:, 3])
    hind = mirror_x(
        smooth_union(
            0.008,
            ellipsoid((0.034, 0.022, 0.034), (0.017, 0.030, 0.032)),
            tube([(0.038, 0.0, 0.034), (0.041, -0.006, 0.014), (0.041, -0.026, 0.008)], (0.015, 0.011, 0.0095)),
            _toes(*_HIND_PAW),
        )
    )
    fore = mirror_x(
        smooth_union(
            0.006,
            tube(
                [(0.018, -0.010, 0.100), (0.027, -0.016, 0.074), (0.023, -0.034, 0.042), (0.021, -0.038, 0.012)],
                (0.016, 0.0135, 0.0088, 0.0085),
            ),
            _toes(*_FORE_PAW),
        )
    )
    arrow = np.array([(-0.004, -0.0635), (-0.013, -0.0560), (-0.036, -0.0690), (-0.015, -0.0775), (-0.005, -0.0690)])
    spade = prism(arrow, -0.004, 0.0062, rounding=0.002)
    trunk = smooth_union(0.010, spine, tail, hind, fore)

    def scales(points: np.ndarray) -> np.ndarray:
        first, second, _ = cell_noise(points, 0.0042, seed)
        return 0.0004 * np.clip((second - first) / 0.3, 0, 1)

    return displace(smooth_union(0.004, trunk, spade, _head()), scales)


def _toes(x: float, y: float) -> Field:
    paw = ellipsoid((x, y, 0.005), (0.0115, 0.012, 0.0085))
    ends = [(x + 0.9 * side, y - 0.012 + 0.25 * abs(side), 0.0045) for side in _TOES]
    return smooth_union(0.003, paw, round_cones([((x, y, 0.006), end, 0.006, 0.004) for end in ends]))


def _claws() -> Field:
    cones = []
    for x, y in (_HIND_PAW, _FORE_PAW):
        for side in _TOES:
            root = (x + 0.9 * side, y - 0.013 + 0.25 * abs(side), 0.0045)
            cones.append((root, (x + 1.1 * side, y - 0.0195 + 0.3 * abs(side), 0.0022), 0.0033, 0.0020))
    return mirror_x(round_cones(cones))


def _head() -> Field:
    skull = ellipsoid((0, -0.026, 0.1795), (0.0155, 0.0185, 0.0140))
    snout = tube([(0, -0.034, 0.1775), (0, -0.050, 0.1760), (0, -0.0625, 0.1745)], (0.0120, 0.0090, 0.0072))
    jaw = tube([(0, -0.026, 0.1700), (0, -0.042, 0.1630), (0, -0.056, 0.1595)], (0.0095, 0.0062, 0.0042))
    brows = mirror_x(round_cone((0.007, -0.020, 0.1925), (0.0095, -0.040, 0.1850), 0.0042, 0.0030))
    nostrils = mirror_x(sphere((0.0038, -0.0655, 0.1790), 0.0036))
    cheeks = mirror_x(sphere((0.0105, -0.026, 0.1730), 0.0075))
    return smooth_union(0.004, skull, snout, jaw, brows, nostrils, cheeks)


def _eyes() -> Field:
    return mirror_x(sphere((0.0122, -0.0365, 0.1815), 0.0036))


def _mouth() -> Field:
    return tube([(0, -0.036, 0.1680), (0, -0.048, 0.1660), (0, -0.057, 0.1640)], (0.0050, 0.0034, 0.0022))


def _horns() -> Field:
    horns = tube(
        [(0.0075, -0.020, 0.189), (0.0135, -0.006, 0.2000), (0.0190, 0.012, 0.2050), (0.0210, 0.028, 0.2130)],
        (0.0044, 0.0036, 0.0028, 0.0020),
    )
    small = tube([(0.0135, -0.018, 0.178), (0.0215, -0.007, 0.181), (0.0255, 0.003, 0.187)], (0.0038, 0.0028, 0.0020))
    chin = tube([(0.0, -0.050, 0.160), (0.0, -0.053, 0.153), (0.0, -0.050, 0.147)], (0.0032, 0.0025, 0.0020))
    return union(mirror_x(union(horns, small)), chin)


def _spikes() -> Field:
    """Set spikes along the outer side of the spine and on top of the tail."""
    cones = []
    back = spline(_SPINE, 6)[5:-3]
    for before, here, after in zip(back[:-2:2], back[1:-1:2], back[2::2], strict=True):
        along = (after - before)[:3] / np.linalg.norm((after - before)[:3])
        out = np.cross(along, (1, 0, 0))
        foot = here[:3] + (here[3] - 0.001) * out
        cones.append((foot, foot + (0.004 + 0.30 * here[3]) * out - 0.004 * along, 0.0042, 0.0020))
    ridge = spline(_TAIL, 4)[3:-4]
    up = np.array([0.0, 0.0, 1.0])
    for before, here, after in zip(ridge[:-2:2], ridge[1:-1:2], ridge[2::2], strict=True):
        along = (after - before)[:3] / np.linalg.norm((after - before)[:3])
        foot = here[:3] + (here[3] - 0.001) * up
        cones.append((foot, foot + (0.002 + 0.45 * here[3]) * up + 0.003 * along, 0.0032, 0.0020))
    return round_cones(cones)


def _belly() -> Field:
    """Plates down the throat and the chest, like those of a snake."""
    forward = np.array([0.0, 0.45, 0.50, 0.62, 0.66, 0.52, 0.45, 0.40])[:, None]
    front = _SPINE[:, :3] - forward * _SPINE[:, 3:] * (0, 1, 0.1)
    strip = tube(front[1:], 0.68 * _SPINE[1:, 3])

    def plates(points: np.ndarray) -> np.ndarray:
        return 0.0008 * np.abs(np.sin(np.pi * (points[:, 2] - 0.25 * points[:, 1]) / 0.0085))

    return displace(strip, plates)


def _wing(field: Field) -> Field:
    """Bring a shape in the plane of a wing to its place, and mirror it."""
    turn = np.radians(24)
    yaw = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])

    def bent(points: np.ndarray) -> np.ndarray:
        # The membrane curves around the body like a hand.
        shift = 6.0 * (points[:, 1] - 0.03) ** 2 + 1.5 * (points[:, 2] - 0.11) ** 2
        return field(points + np.column_stack([shift, 0 * shift, 0 * shift]))

    return mirror_x(place(bent, (0.024, 0.0, 0.0), yaw))


def _membranes() -> Field:
    edge = [_SHOULDER, _WRIST]
    for tip, after in zip(_WING_TIPS, [*_WING_TIPS[1:], _FLANK], strict=True):
        bay = (tip + after) / 2
        bay = bay + 0.22 * (_WRIST - bay)
        edge += list(spline(np.array([tip, bay, after]), 6)[:-1])
    edge.append(_FLANK)
    return _wing(prism(np.array(edge), -0.0020, 0.0020, axis=0, rounding=0.0010))


def _wing_bones() -> Field:
    elbow = (_SHOULDER + _WRIST) / 2 + np.array((-0.004, 0.002))
    arm = _bone([_SHOULDER - np.array((0, 0.004)), elbow, _WRIST], (0.0085, 0.0060, 0.0048))
    knuckles = (_WRIST + _WING_TIPS) / 2 + np.array((0.004, 0.003))
    fingers = [
        _bone([_WRIST, knuckle, tip], (0.0044, 0.0036, 0.0028))
        for knuckle, tip in zip(knuckles, _WING_TIPS, strict=True)
    ]
    thumb = _bone(
        [_WRIST, _WRIST + np.array((-0.006, 0.008)), _WRIST + np.array((-0.006, 0.016))], (0.004, 0.0028, 0.002)
    )
    return _wing(union(arm, thumb, *fingers))


def _bone(knots: list[np.ndarray], radii: tuple[float, ...]) -> Field:
    """Draw a limb in the plane of a wing, (y, z)."""
    return tube([(0.0, *knot) for knot in knots], radii)
