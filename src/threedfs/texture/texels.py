"""Which point of the mesh each texel shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from threedfs.texture.charts import Atlas
from threedfs.types import Mesh

_SLACK = 1.0
"""Texels outside of a face that show its edge: those that interpolation reads."""


@dataclass(frozen=True)
class Texels:
    """The texels that show a face.

    Attributes
    ----------
    row, column : (N,) int64
        Where they are in the texture.
    face : (N,) int64
    weights : (N, 3) float32
        Of the corners of the face; not below 0, and 1 together.
    """

    row: np.ndarray
    column: np.ndarray
    face: np.ndarray
    weights: np.ndarray

    def take(self, which: np.ndarray | slice) -> Texels:
        """Return some of them."""
        return Texels(self.row[which], self.column[which], self.face[which], self.weights[which])

    def interpolate(self, mesh: Mesh, values: np.ndarray) -> np.ndarray:
        """Return the values (N, C) of texels, between those (V, C) of the mesh's vertices."""
        return (self.weights[:, :, None] * values[mesh.faces[self.face]]).sum(axis=1)


def locate_texels(atlas: Atlas) -> Texels:
    """Find the face and the place in it that each texel shows; texels beside a face show its edge."""
    face = np.full(atlas.shape, -1, np.int64)
    weights = np.zeros((*atlas.shape, 3), np.float32)
    for slack in (_SLACK, 0.0):
        _raster(atlas.corners, slack, face, weights)
    row, column = np.nonzero(face >= 0)
    return Texels(row, column, face[row, column], weights[row, column])


@njit(cache=True)
def _raster(corners, slack, shown, weights):
    """Write each face and the weights of its corners at its texels, and up to `slack` texels outside of it."""
    rows, columns = shown.shape
    for face in range(len(corners)):
        ax, ay = corners[face, 0]
        bx, by = corners[face, 1]
        cx, cy = corners[face, 2]
        twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if twice == 0:
            continue
        # how much a weight changes across the slack, on the side opposite to each corner
        limit_a = -slack * np.hypot(cx - bx, cy - by) / abs(twice)
        limit_b = -slack * np.hypot(cx - ax, cy - ay) / abs(twice)
        limit_c = -slack * np.hypot(bx - ax, by - ay) / abs(twice)
        first = max(0, int(np.floor(min(ax, bx, cx) - slack)))
        last = min(columns - 1, int(np.ceil(max(ax, bx, cx) + slack)))
        for row in range(
            max(0, int(np.floor(min(ay, by, cy) - slack))), min(rows - 1, int(np.ceil(max(ay, by, cy) + slack))) + 1
        ):
            for column in range(first, last + 1):
                b = ((column - ax) * (cy - ay) - (row - ay) * (cx - ax)) / twice
                c = ((bx - ax) * (row - ay) - (by - ay) * (column - ax)) / twice
                a = 1 - b - c
                if a >= limit_a and b >= limit_b and c >= limit_c:
                    # held to the face, or a sliver's values run away
                    a, b, c = max(a, 0.0), max(b, 0.0), max(c, 0.0)
                    whole = a + b + c
                    shown[row, column] = face
                    weights[row, column, 0], weights[row, column, 1], weights[row, column, 2] = (
                        a / whole,
                        b / whole,
                        c / whole,
                    )
