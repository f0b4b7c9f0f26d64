"""Voxel grids: laying them over a box, and the way between voxels and world."""

from __future__ import annotations

import numpy as np

from threedfs.types import Box, VoxelGrid


def cover_box(box: Box, longest: int) -> VoxelGrid:
    """Lay a grid of cubic voxels over a box, along its sides, so that its longest side has `longest` voxels.

    The box is covered from face to face: the first voxel centre lies half a voxel inside `low`.
    """
    extent = box.high - box.low
    spacing = float(extent.max() / longest)
    shape = tuple(int(n) for n in np.maximum(np.ceil(extent / spacing - 1e-9), 1))
    return VoxelGrid((box.low + spacing / 2) @ box.axes, spacing, shape, box.axes)


def cut_grid(grid: VoxelGrid, box: Box) -> tuple[VoxelGrid, tuple[slice, slice, slice]]:
    """Return the part of a grid that encloses a box, one voxel at least, and where it lies in the grid."""
    corners = voxel_from_world(grid, box.corners())
    last = np.array(grid.shape) - 1
    low = np.clip(np.floor(corners.min(axis=0)), 0, last).astype(int)
    high = np.clip(np.ceil(corners.max(axis=0)), low, last).astype(int)
    part = tuple(slice(int(start), int(stop) + 1) for start, stop in zip(low, high, strict=True))
    shape = tuple(int(count) for count in high - low + 1)
    return VoxelGrid(world_from_index(grid, low), grid.spacing, shape, grid.axes), part


def world_from_index(grid: VoxelGrid, index: np.ndarray) -> np.ndarray:
    """Return world points (..., 3) float64 of voxel indices (..., 3), whole or between voxel centres."""
    points = (grid.spacing * index) @ grid.axes
    points += grid.origin
    return points


def voxel_places(grid: VoxelGrid, voxels: np.ndarray) -> np.ndarray:
    """Return the world coordinates of the centres of voxels by flat index (N,): (N, 3) float64."""
    return world_from_index(grid, np.stack(np.unravel_index(voxels, grid.shape), axis=-1))


def voxel_centres(grid: VoxelGrid) -> np.ndarray:
    """Return the world coordinates of all voxel centres, (nx, ny, nz, 3) float64."""
    return np.stack(np.meshgrid(*(grid.axis(d) for d in range(3)), indexing="ij"), axis=-1) @ grid.axes


def voxel_from_world(grid: VoxelGrid, points: np.ndarray) -> np.ndarray:
    """Return continuous voxel indices (..., 3) of world points; integers are voxel centres."""
    return (points - grid.origin) @ grid.axes.T / grid.spacing


def voxel_index(grid: VoxelGrid, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Hash world points (N, 3) to the voxels that contain them.

    Returns
    -------
    index : (M, 3) int64
        Voxel of each point that lies in the grid.
    kept : (N,) bool
        Which points those are.
    """
    index = np.floor(voxel_from_world(grid, points) + 0.5)
    kept = np.all((index >= 0) & (index < grid.shape), axis=-1)
    return index[kept].astype(np.int64), kept
