"""Points of the zero level surface of a fused field."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import world_from_index
from threedfs.types import VoxelGrid


def zero_crossings(grid: VoxelGrid, sdf: np.ndarray, seen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find where the field changes sign between neighbouring voxels that views see.

    Parameters
    ----------
    grid : VoxelGrid
    sdf, seen : (nx, ny, nz)
        The field, and the number of views that see each voxel: the border of unseen space is no surface.

    Returns
    -------
    points : (N, 3) float64
        World points, by linear interpolation between voxel centres.
    normals : (N, 3) float64
        Unit normals toward empty space, from central differences of the field.
    """
    points, normals = [], []
    solid = sdf < 0
    for axis in range(3):
        first = tuple(slice(0, -1) if d == axis else slice(None) for d in range(3))
        second = tuple(slice(1, None) if d == axis else slice(None) for d in range(3))
        crosses = (solid[first] != solid[second]) & (seen[first] > 0) & (seen[second] > 0)
        low = np.argwhere(crosses)
        high = low + np.eye(3, dtype=np.int64)[axis]
        a = sdf[tuple(low.T)].astype(np.float64)
        b = sdf[tuple(high.T)].astype(np.float64)
        index = low.astype(np.float64)
        index[:, axis] += a / (a - b)
        points.append(world_from_index(grid, index))
        normals.append(_gradient(sdf, low) + _gradient(sdf, high))
    normal = np.concatenate(normals) @ grid.axes
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.concatenate(points), normal / np.where(length > 0, length, 1)


def _gradient(sdf: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Central differences (N, 3) of the field along the grid's axes at voxels (N, 3), one-sided at its border."""
    columns = []
    for axis in range(3):
        step = np.eye(3, dtype=np.int64)[axis]
        ahead = np.minimum(index + step, np.array(sdf.shape) - 1)
        behind = np.maximum(index - step, 0)
        columns.append(sdf[tuple(ahead.T)].astype(np.float64) - sdf[tuple(behind.T)])
    return np.stack(columns, axis=1)
