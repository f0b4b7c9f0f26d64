"""The table: a slab whose top is the plane z = 0, with sheets of paper or cloth lying flat on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    entry, leave = np.full(len(directions), -np.inf), np.full(len(directions), np.inf)
    axes = np.zeros((2, len(directions)), np.int64)
    for axis in range(3):
        with np.errstate(divide="ignore", invalid="ignore"):
            to_low = (low[axis] - origins[:, axis]) / directions[:, axis]
            to_high = (high[axis] - origins[:, axis]) / directions[:, axis]
        # A ray along the face gives 0 / 0 there; fmin and fmax leave that bound out.
        near, far = np.fmin(to_low, to_high), np.fmax(to_low, to_high)
        axes[0][near > entry] = axis
        axes[1][far < leave] = axis
        entry, leave = np.fmax(entry, near), np.fmin(leave, far)
    return np.where((entry < leave) & (entry > 1e-9), entry, np.inf), leave, axes
