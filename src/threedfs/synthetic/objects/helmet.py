"""A full-face motorcycle helmet, 0.20 long: a glossy shell with hardly any texture, a mirroring visor, vents."""

from __future__ import annotations

import numpy as np

from threedfs.synthetic.fields import (
    Field,
    box,
    cylinder,
    displace,
    ellipsoid,
    half_space,
    intersection,
    mirror_x,
    offset,
    round_cone,
    smooth_union,
    subtract,
    union,
)
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.textures import Colour, mix, plain, speckled

# Radius at which angles around the z axis are unrolled to lengths, and the middle of the visor there.
_UNROLL = 0.085
_VISOR_MIDDLE = 0.0790


def make_helmet(spacing: float = 0.0017, seed: int = 17) -> Solid:
    """Make the helmet: it rests with its rim on z = 0 around the origin and faces -y. It is solid below.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is.
    seed : int
        Seed of its textures.
    """
    lacquer = Material(_lacquer((0.46, 0.018, 0.022), (0.80, 0.80, 0.78), (0.016, 0.016, 0.020), seed), 0.55, 220, 0.05)
    tinted = Material(plain((0.010, 0.011, 0.014), 0.02, 0.03, seed + 1), 0.9, 320, 0.16)
    rubber = Material(speckled((0.022, 0.022, 0.024), (0.040, 0.040, 0.042), 0.002, 0.4, seed + 2), 0.06, 20)
    mesh_grey = Material(plain((0.012, 0.012, 0.013), 0.10, 0.004, seed + 3))
    chrome = Material(plain((0.30, 0.30, 0.31), 0.05, 0.01, seed + 4), 0.7, 150, 0.35)
    shell, slots = _shell(), _slots()
    raised = subtract(displace(shell, _visor_relief), slots)
    parts = [
        # These share one surface; of equal fields the first one counts.
        Part(intersection(raised, _visor_window(0.0)), tinted),
        Part(intersection(raised, _visor_window(0.0030)), rubber),
        Part(raised, lacquer),
        Part(_rim(shell), rubber),
        Part(intersection(offset(shell, -0.0030), slots), mesh_grey),
        Part(_hinges(), rubber),
        Part(_screws(), chrome),
        Part(_scoops(), rubber),
    ]
    return build_solid(parts, (-0.085, -0.115, 0.0), (0.085, 0.105, 0.155), spacing)


def _shell() -> Field:
    skull = ellipsoid((0, 0.008, 0.0720), (0.0760, 0.0900, 0.0710))
    neck = ellipsoid((0, 0.010, 0.0240), (0.0690, 0.0760, 0.0480))
    chin = ellipsoid((0, -0.034, 0.0290), (0.0585, 0.0680, 0.0350))
    ridge = round_cone((0, 0.036, 0.1320), (0, 0.088, 0.0990), 0.0050, 0.0060)
    return smooth_union(0.022, smooth_union(0.030, skull, neck, chin), ridge)


def _unrolled(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Arc length (N,) around the z axis from the front (-y), and height (N,)."""
    return _UNROLL * np.abs(np.arctan2(points[:, 0], -points[:, 1])), points[:, 2]


def _visor_window(margin: float) -> Field:
    """Everything behind the visor's outline, grown by `margin`: a rounded rectangle that narrows to the sides."""

    def field(points: np.ndarray) -> np.ndarray:
        along, height = _unrolled(points)
        rounding = 0.014
        half_height = 0.0265 - 0.010 * (along / 0.125) ** 2
        q = np.stack([along - 0.125 + rounding, np.abs(height - _VISOR_MIDDLE) - half_height + rounding], axis=-1)
        return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0) - rounding - margin

    return field


def _visor_relief(points: np.ndarray) -> np.ndarray:
    """Height (N,) of the visor and its gasket over the shell, with a soft edge that the mesh can follow."""
    share = np.clip(0.5 - _visor_window(0.0030)(points) / 0.006, 0, 1)
    return 0.0022 * share * share * (3 - 2 * share)


def _rim(shell: Field) -> Field:
    return intersection(offset(shell, 0.0020), half_space((0, 0, 0.0080), (0, 0, 1)))


def _hinges() -> Field:
    return mirror_x(cylinder((0.060, 0.008, 0.0790), (0.0790, 0.008, 0.0790), 0.0150, 0.0020))


def _screws() -> Field:
    return mirror_x(cylinder((0.070, 0.008, 0.0790), (0.0815, 0.008, 0.0790), 0.0052, 0.0012))


def _slots() -> Field:
    """Vents: three in the chin, two in the forehead, four in the back."""
    middle = box((0, -0.100, 0.0300), (0.0120, 0.030, 0.0042), 0.0020)
    cheek = mirror_x(box((0.0315, -0.085, 0.0300), (0.0130, 0.030, 0.0042), 0.0020))
    rear = [mirror_x(box((0.020, 0.095, height), (0.0130, 0.030, 0.0030), 0.0015)) for height in (0.050, 0.064)]
    return union(middle, cheek, *rear)


def _scoops() -> Field:
    """Air intakes on the forehead: low humps with a mouth cut into the front."""
    hump = round_cone((0.026, -0.042, 0.1215), (0.030, 0.004, 0.1280), 0.0090, 0.0040)
    mouth = box((0.026, -0.058, 0.1260), (0.0060, 0.0120, 0.0028), 0.0010)
    return mirror_x(subtract(hump, mouth))


def _lacquer(ground: Colour, stripe: Colour, line: Colour, seed: int) -> Texture:
    """Paint: one plain colour, a stripe with thin borders over the crown, and a number in a disc on both sides."""
    base = plain(ground, 0.02, 0.03, seed)

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        edge = np.maximum(footprint, 1e-5)

        def cover(distance: np.ndarray) -> np.ndarray:
            return np.clip(0.5 - distance / edge, 0, 1)

        colour = base(points, footprint)
        across = np.abs(points[:, 0])
        colour = mix(colour, stripe, cover(np.abs(across - 0.0105) - 0.0070))
        colour = mix(colour, line, cover(np.abs(across - 0.0215) - 0.0011))
        flank = across > 0.045
        y, z = points[:, 1] - 0.050, points[:, 2] - 0.060
        colour = mix(colour, stripe, cover(np.hypot(y, z) - 0.0210) * flank)
        colour = mix(colour, line, cover(np.abs(np.hypot(y, z) - 0.0185) - 0.0008) * flank)
        # A seven, written from the left as each side sees it.
        right = y * np.sign(points[:, 0])
        bar = np.maximum(np.abs(right) - 0.0085, np.abs(z - 0.0090) - 0.0018)
        leg = np.maximum(np.abs(right - 0.0045 - 0.42 * (z - 0.0020)) - 0.0022, np.abs(z + 0.0010) - 0.0110)
        return mix(colour, line, cover(np.minimum(bar, leg)) * flank)

    return texture
