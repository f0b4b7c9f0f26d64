"""A compact keyboard, 0.26 wide: a flat wedge with separate keys, gaps between them and small legends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.synthetic.fields import Field, box, place
from threedfs.synthetic.lettering import ADVANCE, WIDTH, encode, letter_ink
from threedfs.synthetic.noise import fractal_noise, hash_cells
from threedfs.synthetic.solid import Material, Part, Solid, Texture, build_solid
from threedfs.synthetic.textures import mix, speckled

# Rows of keys from the front to the back: legend and width in units; a row is 15 units wide.
_ROWS = (
    (("CTRL", 1.25), ("FN", 1.25), ("ALT", 1.25), ("", 6.0), ("ALT", 1.25), *((key, 1.0) for key in ("DEL", *"<->"))),
    (("SHIFT", 2.25), *((key, 1.0) for key in "ZXCVBNM,./"), ("+", 1.0), ("SHIFT", 1.75)),
    (("CAPS", 1.75), *((key, 1.0) for key in "ASDFGHJKL='"), ("ENTER", 2.25)),
    (("TAB", 1.5), *((key, 1.0) for key in "QWERTYUIOP[]"), ("/", 1.5)),
    (*((key, 1.0) for key in ("'", *"1234567890-=")), ("BACK", 2.0)),
    (("ESC", 1.0), *((f"F{n}", 1.0) for n in range(1, 13)), ("INS", 1.0), ("HOME", 1.0)),
)
# Size of a key's place: a unit wide, a pitch deep; the last row is narrower.
_UNIT, _PITCH, _LAST_PITCH = 0.01655, 0.0163, 0.0125
# Between two keys at the deck; how far the top of a key recedes on all sides; its height over the deck.
_GAP, _TAPER, _HEIGHT = 0.0034, 0.0013, 0.0062
_WIDTH, _DEPTH, _FRONT, _TILT = 0.260, 0.110, 0.0105, 3.6  # of the case; height of its front edge, slope in degrees
_MARGIN = 0.006  # of the deck in front of the keys


def make_keyboard(spacing: float = 0.0013, seed: int = 60) -> Solid:
    """Make the keyboard: it lies on z = 0 around the origin, the space bar towards -y.

    Parameters
    ----------
    spacing : float
        Edge of a marching cubes cell; sets how fine the mesh is. Gaps between keys are 0.0034 wide at the deck.
    seed : int
        Seed of its textures.
    """
    layout = _lay_out()
    plastic = Material(speckled((0.055, 0.058, 0.065), (0.085, 0.088, 0.095), 0.0012, 0.35, seed), 0.08, 25)
    printed = Material(_print_keys(layout, seed + 20), 0.10, 30)
    # Deck coordinates: x, y over the slope from its front edge, z above it.
    case = box((0, _DEPTH / 2, -0.05), (_WIDTH / 2, _DEPTH / 2, 0.05), 0.003)
    parts = [
        Part(place(case, _DECK, _SLOPE), plastic),
        Part(place(_keys(layout), _DECK, _SLOPE), printed),
    ]
    return build_solid(parts, (-0.132, -0.057, 0.0), (0.132, 0.057, 0.027), spacing)


def _slope() -> np.ndarray:
    cosine, sine = np.cos(np.radians(_TILT)), np.sin(np.radians(_TILT))
    return np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])


_DECK, _SLOPE = np.array((0.0, -_DEPTH / 2, _FRONT)), _slope()


@dataclass(frozen=True)
class _Layout:
    """The keys (K,), row by row from the left: the edges of the rows' places (R + 1,), the rectangles of the keys'
    places, and their legends."""

    edges: np.ndarray
    row: np.ndarray
    centre: np.ndarray
    half: np.ndarray
    legends: list[str]

    def key_at(self, points: np.ndarray) -> np.ndarray:
        """Return the key (N,) in whose place a point (N, 3) of the deck lies; the nearest one beside the keys."""
        row = np.clip(np.searchsorted(self.edges, points[:, 1]) - 1, 0, len(self.edges) - 2)
        # One sorted list for all rows: a row is farther from the next than it is wide.
        left = self.row + self.centre[:, 0] - self.half[:, 0]
        first = np.searchsorted(self.row, row)
        return np.maximum(np.searchsorted(left, row + np.clip(points[:, 0], -_WIDTH, _WIDTH)) - 1, first)


def _lay_out() -> _Layout:
    edges = _MARGIN + np.cumsum([0.0, *[_PITCH] * (len(_ROWS) - 1), _LAST_PITCH])
    row, centre, half, legends = [], [], [], []
    for index, keys in enumerate(_ROWS):
        right = np.cumsum([width for _, width in keys]) * _UNIT - 7.5 * _UNIT
        for (legend, width), end in zip(keys, right, strict=True):
            row.append(index)
            centre.append((end - width * _UNIT / 2, (edges[index] + edges[index + 1]) / 2))
            half.append((width * _UNIT / 2, (edges[index + 1] - edges[index]) / 2))
            legends.append(legend)
    return _Layout(edges, np.array(row), np.array(centre), np.array(half), legends)


def _keys(layout: _Layout) -> Field:
    """Make the keys in deck coordinates: they taper upwards and have a hollow for the finger."""
    rounding = 0.0013

    def field(points: np.ndarray) -> np.ndarray:
        key = layout.key_at(points)
        local = points[:, :2] - layout.centre[key]
        half = layout.half[key] - _GAP / 2
        hollow = np.where(half[:, 0] < 0.02, 0.0008, -0.0004) * (1 - np.minimum(local[:, 0] / half[:, 0], 1) ** 2)
        across = np.abs(local) - half + (_TAPER * np.clip(points[:, 2] / _HEIGHT, 0, 1))[:, None]
        along = np.abs(points[:, 2]) - (_HEIGHT - hollow)
        q = np.column_stack([across, along]) + rounding
        return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0) - rounding

    return field


def _print_keys(layout: _Layout, seed: int) -> Texture:
    """Make the colour of the keys: pale letters, dark others, and two in red; legends on their tops."""
    kind = np.array([2 if name in ("ESC", "ENTER") else int(len(name) > 1) for name in layout.legends])
    plastic = np.array([(0.60, 0.58, 0.52), (0.17, 0.18, 0.20), (0.52, 0.10, 0.035)])[kind]
    ink = np.array([(0.03, 0.03, 0.035), (0.62, 0.62, 0.60), (0.68, 0.66, 0.60)])[kind]
    length = np.array([len(name) for name in layout.legends])
    letters = np.array([np.resize(encode(name + "     "), 5) for name in layout.legends])
    height = np.where(length > 1, 0.0027, 0.0048)
    start = layout.centre[:, 0] - (length * ADVANCE - (ADVANCE - WIDTH)) / 2 * height

    def texture(points: np.ndarray, footprint: np.ndarray) -> np.ndarray:
        local = (points - _DECK) @ _SLOPE
        key = layout.key_at(local)
        u = (local[:, 0] - start[key]) / height[key]
        v = (local[:, 1] - layout.centre[key, 1]) / height[key] + 0.5
        place = np.floor(u / ADVANCE).astype(int)
        on_top = (place >= 0) & (place < length[key]) & (local[:, 2] > _HEIGHT - 0.002)
        letter = np.where(on_top, letters[key, np.clip(place, 0, 4)], 0)
        cover = letter_ink(letter, u - place * ADVANCE, v, footprint / height[key])
        shade = 0.90 + 0.16 * hash_cells(key, seed=seed)
        worn = 1 + 0.10 * fractal_noise(points, footprint, 0.008, 5, 0.75, seed + 1)
        lit = np.clip((local[:, 2] - 0.0008) / 0.0008, 0.07, 1)  # dirt and dark where a key leaves the deck
        return np.clip(mix(plastic[key], ink[key], cover) * (shade * worn * lit)[:, None], 0, 1)

    return texture
