"""Expansion of a smooth field in Gaussian radial basis functions (Section 3.3.2, Eq. 17)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from threedfs.types import VoxelGrid

_GROUP = 512
"""Most points that are evaluated at once: more of them lie farther apart, and more functions reach them."""

_FARTHEST = 4.0
"""Widths beyond which a function is left out at a point: there it is 1e-7."""


@dataclass(frozen=True)
class PlacedBasis:
    """Basis functions at points, in groups of points that lie near each other, each with the functions that reach it.

    Attributes
    ----------
    points : (N, 3) float64
    centres : (C, 3) float64
    width : float
    groups : tuple of (rows, columns)
        Indices of points and of centres.
    """

    points: np.ndarray
    centres: np.ndarray
    width: float
    groups: tuple[tuple[np.ndarray, np.ndarray], ...]

    def blocks(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Yield rows, columns and the functions there, one group at a time: all at once would be too large."""
        for rows, columns in self.groups:
            yield rows, columns, evaluate_at(self.points[rows], self.centres[columns], self.width)

    def combine(self, coefficients: np.ndarray) -> np.ndarray:
        """Sum the functions with coefficients (C,) at every point: (N,) float64."""
        total = np.empty(len(self.points))
        for rows, columns, block in self.blocks():
            total[rows] = block @ coefficients[columns]
        return total


def place_basis(points: np.ndarray, centres: np.ndarray, width: float) -> PlacedBasis:
    """Group points (N, 3) with the functions, of those at centres (C, 3), that reach them."""
    groups = []
    for rows in _halve(points, np.arange(len(points))):
        low, high = points[rows].min(axis=0), points[rows].max(axis=0)
        outside = np.maximum(np.maximum(low - centres, centres - high), 0)
        groups.append((rows, np.flatnonzero(np.linalg.norm(outside, axis=1) <= _FARTHEST * width)))
    return PlacedBasis(points, centres, width, tuple(groups))


def evaluate_at(points: np.ndarray, centres: np.ndarray, width: float) -> np.ndarray:
    """Return the basis functions at points: (N, C) float64, exp(-|p - c|^2 / width^2).

    Parameters
    ----------
    points : (N, 3) float64
    centres : (C, 3) float64
    width : float
        Distance at which a basis function falls to 1/e, in the unit of the points.
    """
    square = (points**2).sum(1)[:, None] + (centres**2).sum(1) - 2 * points @ centres.T
    np.maximum(square, 0, out=square)
    square /= -(width**2)
    return np.exp(square, out=square)


def evaluate_on_grid(grid: VoxelGrid, centres: np.ndarray, coefficients: np.ndarray, width: float) -> np.ndarray:
    """Sum an expansion at every voxel, (nx, ny, nz) float64.

    A Gaussian is the product of one factor for each axis of the grid, so that a slab of the grid is a product of two
    matrices and no exponential is taken per voxel.

    Parameters
    ----------
    grid : VoxelGrid
    centres : (C, 3) float64
    coefficients : (C,) float64
    width : float
    """
    along = centres @ grid.axes.T
    x, y, z = (np.exp(-(((grid.axis(d)[:, None] - along[:, d]) / width) ** 2)) for d in range(3))
    field = np.empty(grid.shape)
    for slab, factor in zip(field, x * coefficients, strict=True):
        np.matmul(y * factor, z.T, out=slab)
    return field


def _halve(points: np.ndarray, rows: np.ndarray) -> list[np.ndarray]:
    """Split rows of points across their longest side until no part has more than `_GROUP`."""
    if len(rows) <= _GROUP:
        return [rows]
    longest = np.ptp(points[rows], axis=0).argmax()
    ordered = rows[np.argsort(points[rows, longest], kind="stable")]
    half = len(rows) // 2
    return _halve(points, ordered[:half]) + _halve(points, ordered[half:])
