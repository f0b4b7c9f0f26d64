"""A hedgehog, 0.14 long: hundreds of spines over its back, a furry face and belly, feet with claws."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from threedfs.synthetic.fields import (
    Field,
    displace,
    ellipsoid,
    mirror_x,
    round_cone,
    smooth_union,
    sphere,
    union,
)
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.sweeps import round_cones
from threedfs.synthetic.textures import Colour, mix, plain, speckled

# The back: an ellipsoid that carries the spines.
_CENTRE = np.array([0.0, 0.0080, 0.0360])
_RADII = np.array([0.0430, 0.0470, 0.0385])


def make_hedgehog(spacing: float = 0.0013, seed: int = 29) -> Solid:
    """Make the hedgehog: it stands on z = 0 around the origin and faces -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. Above 0.002 the tips of the spines break off.
    seed : int
        Seed of its spines and textures.
    """
    spines = Material(_banded((0.045, 0.028, 0.018), (0.62, 0.52, 0.36), seed), 0.08, 30)
    hide = Material(speckled((0.050, 0.032, 0.020), (0.11, 0.075, 0.045), 0.0020, 0.4, seed + 1))
    fur = Material(_fur((0.50, 0.36, 0.21), (0.15, 0.09, 0.045), seed + 2))
    skin = Material(speckled((0.30, 0.17, 0.12), (0.17, 0.09, 0.06), 0.0020, 0.4, seed + 3), 0.04, 20)
    black = Material(plain((0.012, 0.011, 0.011), 0.1, 0.004, seed + 4), 0.5, 120, 0.04)
    claws = Material(plain((0.16, 0.11, 0.08), 0.2, 0.003, seed + 5), 0.15, 60)
    parts = [
        Part(_back(), hide),
        Part(_spines(seed), spines),
        Part(displace(union(_face(), _belly()), _tufts(seed + 6)), fur),
        Part(_ears(), skin),
        Part(_feet(), skin),
        Part(_claws(), claws),
        Part(union(_nose(), _eyes()), black),
    ]
    return build_solid(parts, (-0.062, -0.081, 0.0), (0.062, 0.078, 0.094), spacing)


def _back() -> Field:
    return ellipsoid(_CENTRE, _RADII)


def _spines(seed: int) -> Field:
    """Cones on a golden spiral over the back, leaning backwards, each a little its own way."""
    rng = np.random.default_rng(seed)
    count = 440
    index = np.arange(count) + 0.5
    height, turn = 1 - 2 * index / count, index * np.pi * (3 - np.sqrt(5))
    ring = np.sqrt(1 - height**2)
    unit = np.column_stack([ring * np.cos(turn), -height, ring * np.sin(turn)])
    unit += rng.normal(0, 0.018, unit.shape)
    unit /= np.linalg.norm(unit, axis=1, keepdims=True)
    root = _CENTRE + _RADII * unit
    # From the brow over the flanks to the tail; face, belly and feet stay free.
    covered = (root[:, 2] > 0.0210) & (root[:, 1] + 0.45 * (0.0750 - root[:, 2]) > -0.0270)
    root, unit = root[covered], unit[covered]
    outward = unit / _RADII
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    lean = outward + np.array([0, 0.55, 0]) + rng.normal(0, 0.16, outward.shape)
    lean /= np.linalg.norm(lean, axis=1, keepdims=True)
    length = rng.uniform(0.0130, 0.0180, len(root))[:, None]
    tip = root + length * lean
    free = np.minimum(_face()(tip), _ears()(tip)) > 0.0065
    ends = zip((root - 0.001 * outward)[free], tip[free], strict=True)
    return round_cones((start, end, 0.0030, 0.0017) for start, end in ends)


def _face() -> Field:
    head = ellipsoid((0, -0.0340, 0.0340), (0.0290, 0.0270, 0.0270))
    snout = round_cone((0, -0.0480, 0.0290), (0, -0.0685, 0.0260), 0.0145, 0.0058)
    cheeks = mirror_x(ellipsoid((0.0150, -0.0470, 0.0270), (0.0095, 0.0110, 0.0105)))
    brow = mirror_x(ellipsoid((0.0110, -0.0525, 0.0450), (0.0075, 0.0065, 0.0045)))
    return smooth_union(0.010, head, snout, cheeks, brow)


def _belly() -> Field:
    return ellipsoid((0, 0.005, 0.0200), (0.0400, 0.0470, 0.0260))


def _tufts(seed: int) -> Callable[[np.ndarray], np.ndarray]:
    def height(points: np.ndarray) -> np.ndarray:
        return 0.0012 * fractal_noise(points / (0.0045, 0.012, 0.0045), 0.0, 1.0, 2, 0.5, seed)

    return height


def _nose() -> Field:
    return ellipsoid((0, -0.0735, 0.0280), (0.0060, 0.0052, 0.0052))


def _eyes() -> Field:
    return mirror_x(sphere((0.0118, -0.0580, 0.0400), 0.0044))


def _ears() -> Field:
    return mirror_x(round_cone((0.0215, -0.0400, 0.0500), (0.0275, -0.0430, 0.0570), 0.0070, 0.0058))


def _feet() -> Field:
    front = round_cone((0.0200, -0.0300, 0.0100), (0.0230, -0.0430, 0.0045), 0.0075, 0.0052)
    back = round_cone((0.0300, 0.0380, 0.0100), (0.0340, 0.0220, 0.0045), 0.0085, 0.0056)
    return mirror_x(union(front, back))


def _claws() -> Field:
    cones = []
    for x, y in ((0.0230, -0.0455), (0.0340, 0.0192)):
        for side in (-0.0040, 0.0, 0.0040):
            cones.append(((x + side, y, 0.0042), (x + 1.4 * side, y - 0.0070, 0.0016), 0.0024, 0.0016))
    return mirror_x(round_cones(cones))


def _fur(light: Colour, dark: Colour, seed: int) -> Texture:
    """Short hair that lies backwards: fine strands along y over patches of another shade."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        strands = fractal_noise(points / (0.0022, 0.0110, 0.0022), footprint / 0.0022, 1.0, 3, 0.7, seed)
        patches = fractal_noise(points, footprint, 0.016, 3, 0.6, seed + 20)
        # The muzzle darkens towards the nose, the belly to the ground.
        muzzle = np.clip((-points[:, 1] - 0.050) / 0.016, 0, 1) * 0.35
        return np.clip(mix(light, dark, 0.38 + muzzle + 0.95 * strands + 0.5 * patches), 0, 1)

    return texture


def _banded(dark: Colour, pale: Colour, seed: int) -> Texture:
    """Spines by their height over the back: a dark root, a pale band, a dark band, a pale tip."""
    back = _back()

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        height = back(points) + 0.0035 * fractal_noise(points, footprint, 0.012, 2, 0.6, seed + 30)
        share = np.interp(height, (0.0005, 0.0030, 0.0055, 0.0080, 0.0100, 0.0125), (0.0, 0.55, 0.5, 0.0, 0.05, 1.0))
        grain = 1 + 0.5 * fractal_noise(points, footprint, 0.0030, 3, 0.7, seed + 40)
        return np.clip(mix(dark, pale, share) * grain[:, None], 0, 1)

    return texture
