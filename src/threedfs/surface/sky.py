"""How much of the sky a place sees past what is solid."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from threedfs.geometry.plane import axes_on
from threedfs.threads import use_threads
from threedfs.types import VoxelGrid

_NEAR = 2.0
"""Voxels from which what lies before a place hides it: the wall that it is beside does not."""
_STEP = 0.7
"""Voxels from one sample of a line of sight to the next."""
_DIRECTIONS = 48
"""Of the sky."""


def rate_openness(
    solid: np.ndarray, places: np.ndarray, grid: VoxelGrid, up: np.ndarray, threads: int = 1
) -> np.ndarray:
    """Return the share of the sky that voxels see past the solid ones, (N,) float64 in [0, 1].

    Not in the paper. Beside a wall it is a half.

    Parameters
    ----------
    solid : (nx, ny, nz) bool
    places : (N,) int
        Flat indices of the voxels.
    grid : VoxelGrid
    up : (3,) float64
        Unit normal of the support plane, world frame.
    threads : int
        Changes no result.
    """
    use_threads(threads)
    index = np.stack(np.unravel_index(places, grid.shape), axis=-1)
    sky = spread_directions(_DIRECTIONS) @ axes_on(up) @ grid.axes.T
    return _look_up(solid, index, float(sum(grid.shape)) * sky) / len(sky)


def spread_directions(count: int) -> np.ndarray:
    """Return unit vectors (count, 3) spread evenly over the upper half of a sphere, along a spiral."""
    rank = np.arange(count) + 0.5
    height, turn = 1 - rank / count, rank * np.pi * (3 - math.sqrt(5))
    across = np.sqrt(1 - height**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), height], axis=-1)


@njit(cache=True, parallel=True)
def _look_up(solid, index, rays):
    """Count the rays (M, 3), in voxels, that meet nothing solid on their way from each voxel (N, 3)."""
    count = np.zeros(len(index))
    for n in prange(len(index)):
        ix, iy, iz = index[n]
        for ray in rays:
            count[n] += is_open(solid, ix, iy, iz, (ix + ray[0], iy + ray[1], iz + ray[2]))
    return count


@njit(cache=True)
def is_open(solid, ix, iy, iz, point):
    """Say whether the line from a voxel to a point, in voxels, meets nothing solid."""
    nx, ny, nz = solid.shape
    dx, dy, dz = point[0] - ix, point[1] - iy, point[2] - iz
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    along = _NEAR
    while along < length:
        share = along / length
        jx, jy, jz = int(ix + share * dx + 0.5), int(iy + share * dy + 0.5), int(iz + share * dz + 0.5)
        if jx < 0 or jy < 0 or jz < 0 or jx >= nx or jy >= ny or jz >= nz:
            return True
        if solid[jx, jy, jz]:
            return False
        along += _STEP
    return True
