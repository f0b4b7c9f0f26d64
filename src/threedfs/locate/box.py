"""The box of the object, from its component on the scene grid."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from threedfs.types import Plane, VoxelGrid


def enclose_object(voxels: np.ndarray, grid: VoxelGrid, plane: Plane, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners (low, high) of a box around the object and its foot on the support plane.

    Parameters
    ----------
    voxels : (nx, ny, nz) bool
        The object above the plane.
    grid : VoxelGrid
    plane : Plane
    margin : float
        What the box exceeds the object by, both sides together, as a share of the object's longest side.
    """
    centres = grid.origin + grid.spacing * np.argwhere(voxels)
    feet = centres - plane.distance(centres)[:, None] * plane.normal
    both = np.concatenate([centres, feet])
    low, high = both.min(axis=0) - grid.spacing / 2, both.max(axis=0) + grid.spacing / 2
    reach = margin / 2 * (high - low).max()
    return low - reach, high + reach


def measure_thickness(voxels: np.ndarray, spacing: float) -> float:
    """Return the diameter of the largest ball that fits into the voxels (nx, ny, nz) bool, scene units."""
    (box,) = ndimage.find_objects(voxels.astype(np.uint8))
    inside = np.pad(voxels[box], 1)
    return float(spacing * (2 * ndimage.distance_transform_edt(inside).max() - 1))
