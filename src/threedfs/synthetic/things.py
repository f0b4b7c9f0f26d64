"""Flat things that lie around an object: what a camera's path is found by."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.synthetic.solid import Material, Solid
from threedfs.synthetic.surfaces import pictured, scattered
from threedfs.synthetic.table import Sheet
from threedfs.synthetic.textures import plain, printed, woven

_PAPER = ((0.78, 0.76, 0.70), (0.70, 0.72, 0.72), (0.74, 0.66, 0.50), (0.60, 0.66, 0.70), (0.76, 0.64, 0.60))
_INK = ((0.03, 0.03, 0.035), (0.03, 0.06, 0.16), (0.22, 0.05, 0.05), (0.03, 0.10, 0.06), (0.16, 0.08, 0.02))
_CLOTH = ((0.17, 0.30, 0.33), (0.45, 0.16, 0.12), (0.16, 0.20, 0.42), (0.38, 0.34, 0.14), (0.30, 0.14, 0.30))


@dataclass(frozen=True)
class Thing:
    """A sheet that has no place yet: half sizes (x, y) and material."""

    half: tuple[float, float]
    material: Material


def page(seed: int, half: tuple[float, float] = (0.105, 0.148)) -> Thing:
    """Make a printed page; its colours follow from the seed."""
    paper, ink = _PAPER[seed % 5], _INK[(seed // 5) % 5]
    return Thing(half, Material(printed(paper, ink, 0.0065 + 0.0004 * (seed % 7), seed), 0.04, 30))


def card(seed: int, half: tuple[float, float] = (0.074, 0.052)) -> Thing:
    """Make a picture postcard."""
    return Thing(half, Material(pictured(half, 0.006, seed), 0.12, 60))


def napkin(seed: int, half: tuple[float, float] = (0.10, 0.10)) -> Thing:
    """Make a woven napkin."""
    return Thing(half, Material(woven(_CLOTH[seed % 5], (0.52, 0.50, 0.44), 0.0024 + 0.0002 * (seed % 6), seed)))


def wrapping(seed: int, half: tuple[float, float] = (0.12, 0.09)) -> Thing:
    """Make a piece of wrapping paper with rings and dots."""
    inks = [_CLOTH[(seed + k) % 5] for k in (1, 2, 3)]
    return Thing(half, Material(scattered(_PAPER[(seed // 3) % 5], [*inks, (0.8, 0.75, 0.6)], 0.035, seed), 0.08, 50))


def note(seed: int, half: tuple[float, float] = (0.038, 0.038)) -> Thing:
    """Make a blank sticky note."""
    colour = ((0.78, 0.68, 0.20), (0.75, 0.35, 0.45), (0.35, 0.65, 0.35), (0.30, 0.55, 0.75))[seed % 4]
    return Thing(half, Material(plain(colour, 0.05, 0.03, seed), 0.02, 20))


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
