"""A stack of three hardbacks, slightly twisted: printed covers, lettered spines, page edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.synthetic.fields import box, union
from threedfs.synthetic.noise import fractal_noise
from threedfs.synthetic.objects.placing import about_z, placed
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.textures import Colour, fade, mix, photograph, printed

_BOARD = 0.0028
_OVERHANG = 0.0035


@dataclass(frozen=True)
class _Book:
    """Half sizes (x along the spine's normal, y along the spine), thickness, twist in degrees, centre, colours."""

    half: tuple[float, float]
    thickness: float
    twist: float
    centre: tuple[float, float]
    cloth: Colour
    ink: Colour
    gloss: float


_STACK = (
    _Book((0.080, 0.115), 0.027, 4.0, (0.0, 0.0), (0.20, 0.035, 0.030), (0.70, 0.60, 0.36), 0.05),
    _Book((0.068, 0.102), 0.020, -9.0, (0.004, -0.003), (0.05, 0.10, 0.17), (0.72, 0.70, 0.62), 0.30),
    _Book((0.057, 0.088), 0.015, 16.0, (-0.005, 0.004), (0.62, 0.52, 0.30), (0.05, 0.05, 0.07), 0.15),
)


def make_books(spacing: float = 0.0013, seed: int = 61) -> Solid:
    """Make the stack: it lies on z = 0 around the origin.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell.
    seed : int
        Seed of covers and pages.
    """
    parts, level = [], 0.0
    for number, book in enumerate(_STACK):
        parts += _make_book(book, level, seed + 20 * number)
        # The next book sinks in by a hair, so that the stack hangs together.
        level += book.thickness - 0.0003
    return build_solid(parts, (-0.105, -0.135, 0.0), (0.105, 0.135, level + 0.002), spacing)


def _make_book(book: _Book, level: float, seed: int) -> list[Part]:
    (x, y), up = book.half, book.thickness / 2
    boards = union(
        box((0, 0, up - _BOARD / 2), (x, y, _BOARD / 2), 0.0008),
        box((0, 0, -up + _BOARD / 2), (x, y, _BOARD / 2), 0.0008),
        box((-x + 0.002, 0, 0), (0.0032, y, up), 0.002),
    )
    block = box((0.0, 0, 0), (x - _OVERHANG, y - _OVERHANG, up - _BOARD / 2))
    cover = Material(_cover(book, seed), book.gloss, 50, 0.03 * (book.gloss > 0.2))
    pages = Material(_pages(seed + 9))
    where, turn = (*book.centre, level + up), about_z(book.twist)
    return [placed(boards, cover, where, turn), placed(block, pages, where, turn)]


def _pages(seed: int) -> Texture:
    """Edges of paper: fine layers along z, yellowed."""

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        layers = fractal_noise(points * (0.02, 0.02, 1), footprint, 0.0018, 4, 0.8, seed)
        stain = fractal_noise(points, footprint, 0.04, 4, 0.6, seed + 1)
        return np.clip(np.array([0.70, 0.62, 0.46]) * (1 + 0.45 * layers + 0.20 * stain)[:, None], 0, 1)

    return texture


def _cover(book: _Book, seed: int) -> Texture:
    """Cover in the book's own coordinates: picture and title on top, lettering on the spine, cloth all over."""
    (x, y), up = book.half, book.thickness / 2
    title = printed(book.cloth, book.ink, 0.30 * x, seed + 2)
    small = printed(book.cloth, book.ink, 0.09 * x, seed + 3)
    letters = printed(book.cloth, book.ink, 0.9 * up, seed + 4)

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        weave = fractal_noise(points, footprint, 0.0030, 3, 0.8, seed)
        worn = fractal_noise(points, footprint, 0.06, 6, 0.65, seed + 1)
        cloth = np.asarray(book.cloth) * (1 + 0.35 * weave * fade(0.0015, footprint) + 0.35 * worn)[:, None]
        edge = np.maximum(footprint, 0.0002)

        def share(inside: np.ndarray, where: np.ndarray) -> np.ndarray:
            return np.where(where, np.clip(inside / edge + 0.5, 0, 1), 0)

        def block(low: float, high: float, wide: float) -> np.ndarray:
            return np.minimum(wide - np.abs(points[:, 0]), np.minimum(points[:, 1] - low, high - points[:, 1]))

        top = points[:, 2] > up - 0.0008
        spine = points[:, 0] < -x
        flat = points * (1, 1, 0)
        picture = photograph(flat, footprint, 0.7 * x, seed + 6)
        colour = mix(cloth, title(flat, footprint), share(block(0.45 * y, 0.88 * y, 0.80 * x), top))
        colour = mix(colour, picture, share(block(-0.62 * y, 0.36 * y, 0.76 * x), top))
        colour = mix(colour, small(flat, footprint), share(block(-0.90 * y, -0.70 * y, 0.60 * x), top))
        along = np.column_stack([points[:, 1], points[:, 2], np.zeros(len(points))])
        on_spine = np.minimum(0.75 * y - np.abs(points[:, 1]), 0.62 * up - np.abs(points[:, 2]))
        return np.clip(mix(colour, letters(along, footprint), share(on_spine, spine)), 0, 1)

    return texture
