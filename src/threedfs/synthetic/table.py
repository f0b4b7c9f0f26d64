"""The table: a slab whose top is the plane z = 0, with sheets of paper or cloth lying flat on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from threedfs.synthetic.solid import Material


@dataclass(frozen=True)
class Sheet:
    """A thin rectangle on the table: its centre (x, y), half sizes, and turn about z in degrees.

    Its texture is read in its own x, y, with the origin at its centre.
    """

    centre: tuple[float, float]
    half: tuple[float, float]
    angle: float
    material: Material

    def local(self, points: np.ndarray) -> np.ndarray:
        """Return points (N, 3) in the sheet's own coordinates."""
        turn = np.radians(self.angle)
        x, y = points[:, 0] - self.centre[0], points[:, 1] - self.centre[1]
        cosine, sine = np.cos(turn), np.sin(turn)
        return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, points[:, 2]])


@dataclass(frozen=True)
class Table:
    """A slab with half sizes `half` (x, y), `thickness` high, of one material, under sheets.

    Later sheets lie over earlier ones.
    """

    half: tuple[float, float]
    material: Material
    sheets: tuple[Sheet, ...] = ()
    thickness: float = 0.03

    def albedo(self, points: np.ndarray, footprint: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return linear RGB (N, 3), and specular strength and shininess (N, 2), at points of its surface."""
        colour = self.material.texture(points, footprint)
        gloss = np.tile([self.material.specular, self.material.shininess], (len(points), 1))
        for sheet in self.sheets:
            local = sheet.local(points)
            # The edge of a sheet is blended over a pixel.
            inside = np.minimum(sheet.half[0] - np.abs(local[:, 0]), sheet.half[1] - np.abs(local[:, 1]))
            share = np.clip(inside / np.maximum(footprint, 1e-12) + 0.5, 0, 1)
            on = np.flatnonzero((share > 0) & (points[:, 2] > -1e-6))
            own = sheet.material.texture(local[on], footprint[on])
            colour[on] += share[on, None] * (own - colour[on])
            gloss[on] = (sheet.material.specular, sheet.material.shininess)
        return colour, gloss


def enter_box(
    origins: np.ndarray, directions: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Meet rays (N, 3) with a box from outside and from inside (slab method).

    Returns
    -------
    entry, leave : (N,) float64
        Distances in lengths of the direction; `entry` is infinite where the box is missed.
    axes : (2, N) int64
        The axis of the face met at entry and at leaving.
    """
    return _enter_box(origins, directions, np.asarray(low, np.float64), np.asarray(high, np.float64))


@njit(cache=True, error_model="numpy")
def _enter_box(origins, directions, low, high):
    count = len(directions)
    entry, leave, axes = np.empty(count), np.empty(count), np.zeros((2, count), np.int64)
    for n in range(count):
        first, last = -np.inf, np.inf
        for axis in range(3):
            to_low = (low[axis] - origins[n, axis]) / directions[n, axis]
            to_high = (high[axis] - origins[n, axis]) / directions[n, axis]
            # a ray along the face gives 0 / 0 there, which is neither smaller nor larger: leave that bound out
            near = to_high if to_high < to_low or to_low != to_low else to_low
            far = to_high if to_high > to_low or to_low != to_low else to_low
            if near > first:
                first, axes[0, n] = near, axis
            if far < last:
                last, axes[1, n] = far, axis
        entry[n], leave[n] = first if first < last and first > 1e-9 else np.inf, last
    return entry, leave, axes
