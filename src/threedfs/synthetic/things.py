"""Flat things that lie around an object: what a camera's path is found by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.synthetic.solid import Material, Solid
from threedfs.synthetic.surfaces import pictured, scattered
from threedfs.synthetic.table import Sheet
from threedfs.synthetic.textures import Colour, plain, printed, woven

_PAPER = ((0.78, 0.76, 0.70), (0.70, 0.72, 0.72), (0.74, 0.66, 0.50), (0.60, 0.66, 0.70), (0.76, 0.64, 0.60))
_INK = ((0.03, 0.03, 0.035), (0.03, 0.06, 0.16), (0.22, 0.05, 0.05), (0.03, 0.10, 0.06), (0.16, 0.08, 0.02))
_CLOTH = ((0.17, 0.30, 0.33), (0.45, 0.16, 0.12), (0.16, 0.20, 0.42), (0.38, 0.34, 0.14), (0.30, 0.14, 0.30))
_NOTE = ((0.78, 0.68, 0.20), (0.75, 0.35, 0.45), (0.35, 0.65, 0.35), (0.30, 0.55, 0.75), (0.80, 0.50, 0.22))


@dataclass(frozen=True)
class Thing:
    """A sheet that has no place yet: half sizes (x, y) and material."""

    half: tuple[float, float]
    material: Material


def page(seed: int, half: tuple[float, float] = (0.105, 0.148)) -> Thing:
    """Make a printed page; its colours and its type follow from the seed."""
    paper, ink = _draw(_PAPER, seed), _draw(_INK, seed + 1)
    line = float(np.random.default_rng(seed).uniform(0.0055, 0.0095))
    return Thing(half, Material(printed(paper, ink, line, _spread(seed)), 0.04, 30))


def card(seed: int, half: tuple[float, float] = (0.074, 0.052)) -> Thing:
    """Make a picture postcard."""
    return Thing(half, Material(pictured(half, 0.006, _spread(seed)), 0.12, 60))


def napkin(seed: int, half: tuple[float, float] = (0.10, 0.10)) -> Thing:
    """Make a woven napkin."""
    thread = float(np.random.default_rng(seed).uniform(0.0022, 0.0040))
    return Thing(half, Material(woven(_draw(_CLOTH, seed), _draw(_PAPER, seed + 1), thread, _spread(seed))))


def wrapping(seed: int, half: tuple[float, float] = (0.12, 0.09)) -> Thing:
    """Make a piece of wrapping paper with rings and dots."""
    inks = [_draw(_CLOTH + _PAPER, seed + k) for k in range(1, 5)]
    size = float(np.random.default_rng(seed).uniform(0.020, 0.050))
    return Thing(half, Material(scattered(_draw(_CLOTH + _PAPER, seed), inks, size, _spread(seed)), 0.08, 50))


def note(seed: int, half: tuple[float, float] = (0.038, 0.038)) -> Thing:
    """Make a blank sticky note."""
    return Thing(half, Material(plain(_draw(_NOTE, seed), 0.05, 0.03, _spread(seed)), 0.02, 20))


def _draw(colours: tuple[Colour, ...], seed: int) -> Colour:
    return colours[int(np.random.default_rng(seed).integers(len(colours)))]


def _spread(seed: int) -> int:
    """Textures take several seeds, from their own upwards: keep those of neighbours apart."""
    return 101 * seed


def lay_around(solid: Solid, things: Sequence[Thing], seed: int, gap: tuple[float, float] = (0.01, 0.06)) -> tuple:
    """Lay things around an object on the table, each as near to it as its own random gap allows.

    Parameters
    ----------
    solid : Solid
    things : sequence of Thing
        In counter-clockwise order; later ones lie over earlier ones.
    seed : int
        Of their directions, turns and gaps.
    gap : (2,) float
        Least and largest gap between thing and object, scene units.

    Returns
    -------
    tuple of Sheet
    """
    rng = np.random.default_rng(seed)
    outline = solid.mesh.vertices[:: max(1, len(solid.mesh.vertices) // 4000)]
    middle = (outline[:, :2].min(axis=0) + outline[:, :2].max(axis=0)) / 2
    first = rng.uniform(0, 360)
    sheets = []
    for number, thing in enumerate(things):
        direction = np.radians(first + 360 * (number + rng.uniform(-0.25, 0.25)) / len(things))
        turn, clear = rng.uniform(-90, 90), rng.uniform(*gap)
        reach = 0.0
        while True:
            centre = middle + reach * np.array([np.cos(direction), np.sin(direction)])
            sheet = Sheet((float(centre[0]), float(centre[1])), thing.half, float(turn), thing.material)
            if np.all(np.any(np.abs(sheet.local(outline)[:, :2]) > np.asarray(thing.half) + clear, axis=1)):
                break
            reach += 0.004
        sheets.append(sheet)
    return tuple(sheets)
