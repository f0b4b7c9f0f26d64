"""A two-hole paper punch, 0.12 wide: enamelled body, steel pins, and a lever of thin sheet raised at the back."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import Field, box, cylinder, mirror_x, round_cone, smooth_union, subtract, torus, union
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.sweeps import prism, ribbon, rounded_rectangle, spline
from threedfs.synthetic.textures import fade, lettered, mix, plain, speckled

_PIVOT = (-0.006, 0.0405)  # of the lever, (y, z); its axis is along x
_PINS = 0.034  # of the two holes from the middle, along x
_GUIDE = 0.0088  # height of the paper guide's underside


def make_paper_punch(spacing: float = 0.0011, seed: int = 80) -> Solid:
    """Make the punch: it stands on z = 0 around the origin; paper goes in from -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. The lever's sheet is 0.003 thick.
    seed : int
        Seed of its textures.
    """
    rubber = Material(speckled((0.045, 0.045, 0.048), (0.075, 0.075, 0.078), 0.0016, 0.4, seed), 0.06, 20)
    teal = plain((0.012, 0.17, 0.21), 0.05, 0.02, seed + 10)
    name = lettered(teal, (0.62, 0.62, 0.58), ["NORDA 80"], 0.0058, (0, -0.014, 0.0235), (1, 0, 0), (0, 0, 1))
    body = Material(name, 0.40, 110, 0.04)
    enamel = Material(plain((0.014, 0.19, 0.235), 0.05, 0.02, seed + 20), 0.40, 110, 0.04)
    steel = Material(plain((0.26, 0.26, 0.27), 0.07, 0.005, seed + 30), 0.5, 120, 0.38)
    guide = Material(_ruler(seed + 40), 0.15, 50)
    grip = Material(speckled((0.040, 0.040, 0.043), (0.065, 0.065, 0.068), 0.0012, 0.4, seed + 60), 0.10, 25)
    parts = [
        Part(_tray(), rubber),
        Part(_body(), body),
        Part(union(_cheeks(), _lever()), enamel),
        Part(_pins(), steel),
        Part(_guide(), guide),
        Part(_grip(), grip),
    ]
    return build_solid(parts, (-0.06, -0.046, 0.0), (0.07, 0.052, 0.095), spacing)


def _tray() -> Field:
    return prism(rounded_rectangle((0, 0.002), (0.0525, 0.0380), 0.010), -0.02, 0.0085, rounding=0.0025)


def _body() -> Field:
    """The bridge over the slot that takes the paper, open at the front and at both ends."""
    bed = box((0, 0.000, 0.0105), (0.0480, 0.0280, 0.0035), 0.0012)
    bridge = box((0, 0.002, 0.0240), (0.0480, 0.0160, 0.0055), 0.0030)
    spine = box((0, 0.0150, 0.0180), (0.0480, 0.0060, 0.0090), 0.0012)
    return union(smooth_union(0.003, bridge, spine), bed)


def _cheeks() -> Field:
    outline = spline(
        [(-0.020, 0.022), (-0.014, 0.041), (-0.006, 0.0480), (0.003, 0.043), (0.018, 0.029), (0.022, 0.020)],
        16,
        closed=True,
    )
    return mirror_x(prism(outline, 0.0440, 0.0480, axis=0, rounding=0.001))


def _lever() -> Field:
    """Sheet metal from over the pins up to the grip, with an opening in its middle, and two sides down to the axle."""
    curve = spline(
        [(-0.019, 0.0400), (-0.010, 0.0465), (0.004, 0.0530), (0.020, 0.0630), (0.034, 0.0750), (0.043, 0.0850)], 16
    )
    sheet = prism(ribbon(curve, 0.0031), -0.0420, 0.0420, axis=0, rounding=0.0010)
    opening = rounded_rectangle((0, 0.0170), (0.0220, 0.0130), 0.008)
    web = [
        (-0.016, 0.0370),
        (-0.012, 0.0460),
        (0.004, 0.0535),
        (0.018, 0.0620),
        (0.016, 0.0560),
        (0.003, 0.0420),
        (-0.006, 0.0345),
    ]
    sides = mirror_x(prism(np.array(web), 0.0388, 0.0420, axis=0, rounding=0.0010))
    return union(subtract(sheet, prism(opening, 0.04, 0.10)), sides)


def _pins() -> Field:
    pins = cylinder((_PINS, -0.006, 0.0120), (_PINS, -0.006, 0.0465), 0.0038, 0.0006)
    springs = union(*(torus((_PINS, -0.006, z), (0, 0, 1), 0.0048, 0.0013) for z in (0.0305, 0.0336, 0.0367, 0.0398)))
    axle = cylinder((0.036, *_PIVOT), (0.0495, *_PIVOT), 0.0032, 0.0008)
    return mirror_x(union(pins, springs, axle))


def _guide() -> Field:
    rule = box((0.030, -0.0300, _GUIDE + 0.0012), (0.0360, 0.0052, 0.0020), 0.0006)
    stop = box((0.0645, -0.0260, 0.0120), (0.0017, 0.0092, 0.0050), 0.0008)
    return union(rule, stop)


def _grip() -> Field:
    return round_cone((-0.0385, 0.0430, 0.0845), (0.0385, 0.0430, 0.0845), 0.0050, 0.0050)


def _ruler(seed: int) -> Texture:
    """Make a pale strip with a tick every 5 mm, longer ones every 10."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        place = points[:, 0] / 0.005
        nearest = np.rint(place)
        length = np.where(nearest % 2 == 0, 0.006, 0.0035)
        width = np.maximum(0.0005, footprint / 2)
        line = np.clip(1.5 - np.abs(place - nearest) * 0.005 / width, 0, 1) * (points[:, 1] + 0.0352 < length)
        worn = 1 + 0.12 * fractal_noise(points, footprint, 0.006, 4, 0.7, seed)
        return np.clip(mix((0.66, 0.64, 0.56), (0.05, 0.05, 0.06), line * fade(0.005, footprint)) * worn[:, None], 0, 1)

    return texture
