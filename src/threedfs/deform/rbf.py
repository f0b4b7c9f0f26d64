"""Expansion of a smooth field in Gaussian radial basis functions (Section 3.3.2, Eq. 17)."""

from __future__ import annotations

import numpy as np

from threedfs.types import VoxelGrid


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
    np.maximum(square, 0, out=square)  # in place: the fit's matrices are the largest arrays of the stage
    square /= -(width**2)
    return np.exp(square, out=square)


def evaluate_on_grid(grid: VoxelGrid, centres: np.ndarray, coefficients: np.ndarray, width: float) -> np.ndarray:
    """Sum an expansion at every voxel, (nx, ny, nz) float64.

    A Gaussian is the product of one factor an axis, so that a slab of the grid is a product of two matrices and no
    exponential is taken per voxel.

    Parameters
    ----------
    grid : VoxelGrid
    centres : (C, 3) float64
    coefficients : (C,) float64
    width : float
    """
    x, y, z = (np.exp(-(((places - centres[:, axis]) / width) ** 2)) for axis, places in _axes(grid))
    field = np.empty(grid.shape)
    for slab, factor in zip(field, x * coefficients, strict=True):
        np.matmul(y * factor, z.T, out=slab)
    return field


def _axes(grid: VoxelGrid) -> list[tuple[int, np.ndarray]]:
    """Return each axis with the positions of its voxels, as a column."""
    return [
        (axis, (grid.origin[axis] + grid.spacing * np.arange(count))[:, None]) for axis, count in enumerate(grid.shape)
    ]
