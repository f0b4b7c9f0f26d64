"""A tea caddy of lacquered tin, 0.12 high: a label in front, print behind, bare gloss on the sides and the lid."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import Field, box, cylinder, smooth_union, subtract, torus, union
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.objects.placing import placed, side_of_box
from threedfs.synthetic.solid import Material, Solid, Texture, build_solid
from threedfs.synthetic.textures import mix, photograph, plain, printed

_HALF = (0.042, 0.034, 0.046)
_LACQUER = (0.010, 0.060, 0.045)
_GOLD = (0.42, 0.27, 0.07)


def make_teabox(spacing: float = 0.0009, seed: int = 51) -> Solid:
    """Make the caddy: it stands on z = 0 around the origin, its label faces -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell.
    seed : int
        Seed of its print.
    """
    tin = Material(_lithograph(seed), 0.45, 110, 0.05)
    lacquer = Material(plain(_LACQUER, 0.03, 0.03, seed + 1), 0.5, 140, 0.06)
    gold = Material(plain(_GOLD, 0.06, 0.01, seed + 2), 0.6, 90, 0.22)
    straight = np.eye(3)
    parts = [
        placed(box((0, 0, 0), _HALF, 0.004), tin, (0, 0, _HALF[2]), straight),
        placed(_band(), gold, (0, 0, 2 * _HALF[2]), straight),
        placed(_lid(), lacquer, (0, 0, 2 * _HALF[2]), straight),
        placed(_knob(), gold, (0, 0, 2 * _HALF[2]), straight),
    ]
    return build_solid(parts, (-0.056, -0.052, 0.0), (0.056, 0.052, 0.135), spacing)


def _band() -> Field:
    return box((0, 0, 0.0012), (_HALF[0] + 0.0008, _HALF[1] + 0.0008, 0.0032), 0.001)


def _lid() -> Field:
    rim = box((0, 0, 0.014), (_HALF[0] + 0.0014, _HALF[1] + 0.0014, 0.0115), 0.004)
    dome = box((0, 0, 0.023), (_HALF[0] - 0.009, _HALF[1] - 0.009, 0.006), 0.005)
    groove = subtract(
        box((0, 0, 0.0262), (_HALF[0] - 0.0045, _HALF[1] - 0.0045, 0.0022), 0.001),
        box((0, 0, 0.0262), (_HALF[0] - 0.0085, _HALF[1] - 0.0085, 0.01)),
    )
    return subtract(union(rim, dome), groove)


def _knob() -> Field:
    stem = cylinder((0, 0, 0.027), (0, 0, 0.035), 0.0035)
    head = cylinder((0, 0, 0.0335), (0, 0, 0.0385), 0.0085, 0.002)
    return union(smooth_union(0.003, stem, head), torus((0, 0, 0.029), (0, 0, 1), 0.006, 0.0016))


def _lithograph(seed: int) -> Texture:
    """Paint of the tin, in coordinates around its middle: a label on -y, text on +y, bare lacquer on the sides."""
    text = printed((0.62, 0.55, 0.36), (0.02, 0.05, 0.04), 0.0038, seed + 3)
    title = printed((0.70, 0.62, 0.42), (0.30, 0.03, 0.03), 0.0085, seed + 4)

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        side, flat = side_of_box(points, _HALF)
        colour = np.asarray(_LACQUER) * (1 + 0.05 * fractal_noise(points, footprint, 0.02, 4, 0.6, seed))[:, None]
        for face, paint in ((2, front), (3, back)):
            on = np.flatnonzero(side == face)
            colour[on] = paint(colour[on], flat[on], footprint[on])
        return np.clip(colour, 0, 1)

    def front(colour: np.ndarray, flat: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        colour = _paint(colour, np.tile(_GOLD, (len(flat), 1)), _panel(flat, 0.033, 0.037), footprint)
        letters = title(flat + np.array([0.004, 0.001, 0.0]), footprint)
        colour = _paint(colour, letters, _panel(flat, 0.0312, 0.0352), footprint)
        oval = 0.019 * (1 - np.hypot(flat[:, 0] / 0.026, (flat[:, 1] + 0.006) / 0.019))
        return _paint(colour, photograph(flat, footprint, 0.03, seed + 6), oval, footprint)

    def back(colour: np.ndarray, flat: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        return _paint(colour, text(flat, footprint), _panel(flat, 0.030, 0.034), footprint)

    return texture


def _panel(flat: np.ndarray, half_x: float, half_y: float) -> np.ndarray:
    """Distance (N,) inside the border of a rounded rectangle, negative outside."""
    q = np.maximum(np.abs(flat[:, :2]) - (half_x - 0.006, half_y - 0.006), 0)
    return 0.006 - np.hypot(q[:, 0], q[:, 1])


def _paint(colour: np.ndarray, ink: np.ndarray, inside: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    return mix(colour, ink, np.clip(inside / np.maximum(footprint, 0.0002) + 0.5, 0, 1))
