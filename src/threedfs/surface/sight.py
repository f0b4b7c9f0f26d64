"""Space is free where views see it and find it free: pits that few can look into are filled."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.geometry.grid import voxel_from_world
from threedfs.geometry.plane import axes_on
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.threads import use_threads

_NEAR = 2.0
"""Voxels from which what lies before a place hides it: the wall that it is beside does not."""
_CLEAR = 1.0
"""Voxels before the depth of a view, from which it finds a place free."""
_STEP = 0.7
"""Voxels from one sample of a line of sight to the next."""
_DIRECTIONS = 48
"""Of the sky."""
_OPEN = 0.4
"""Share of the sky that a place sees from which it is in no pit: beside a wall it is a half."""
_RAMP = 2.0
"""Views that a place lacks, from which the field there is fully solid."""


def fill_unseen(
    field: np.ndarray, hull: np.ndarray, above: np.ndarray, up: np.ndarray, depth: ConfirmedDepth, share: float
) -> np.ndarray:
    """Return the field (nx, ny, nz) float32 with pits that too few views see and find free made solid.

    Not in the paper. A wrong depth that some views agree on carves a pit, and behind its mouth a cave. In a true
    hollow every view that can look in finds it free; in such a pit few can, and those that can find its mouth closed.
    What few views see because few were taken from there is no pit: it is open to the sky.

    Parameters
    ----------
    field : (nx, ny, nz) float32
        Negative inside the object.
    hull : (nx, ny, nz) float32
        Negative where the masks allow the object.
    above : (nx, ny, nz) bool
        Voxels above the support plane, which may be filled and which views may look through.
    up : (3,) float64
        Unit normal of the support plane.
    depth : ConfirmedDepth
    share : float
        Of the views with depth, which must find a place free on an object whose depth is not sure at all; the surer
        it is, the fewer.
    """
    least = round(share * (1 - depth.sureness) * len(depth.views))
    places = np.flatnonzero(above & (hull < 0) & (field >= 0))
    if not least or not len(places):
        return field
    use_threads(depth.threads)
    solid = (field < 0) | ~above
    count = _count_sights(solid, places, depth)
    places, count = places[count < least], count[count < least]
    narrow = _rate_openness(solid, places, depth, up) < _OPEN
    filled = field.copy()
    filled.reshape(-1)[places[narrow]] = np.clip((count[narrow] - least) / _RAMP, -1, 0).astype(np.float32)
    return filled


def _count_sights(solid: np.ndarray, places: np.ndarray, depth: ConfirmedDepth) -> np.ndarray:
    """Return how many views see voxels by flat index (N,) past the solid ones, and find them free: (N,) int32."""
    grid = depth.fused.grid
    index = np.stack(np.unravel_index(places, grid.shape), axis=-1)
    count = np.zeros(len(places), np.int32)
    for name, view in depth.views.items():
        centre = voxel_from_world(grid, view.centre)
        _count(solid, index, relate(grid, view), invert_depth(depth.read(name)), grid.spacing, centre, _CLEAR, count)
    return count


def _rate_openness(solid: np.ndarray, places: np.ndarray, depth: ConfirmedDepth, up: np.ndarray) -> np.ndarray:
    """Return the share of the sky that voxels by flat index (N,) see past the solid ones, (N,) float64 in [0, 1]."""
    grid = depth.fused.grid
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
            count[n] += _is_open(solid, ix, iy, iz, (ix + ray[0], iy + ray[1], iz + ray[2]))
    return count


@njit(cache=True, parallel=True)
def _count(solid, index, rays, inverse_depth, spacing, centre, clear, count):
    for n in prange(len(index)):
        ix, iy, iz = index[n]
        # a discontinuity of 0: the nearest pixel's depth, as no mean of two surfaces says that a place is free
        distance, _, _, _ = measure_voxel(rays, ix, iy, iz, inverse_depth, spacing, 0.0)
        if distance > clear and _is_open(solid, ix, iy, iz, centre):
            count[n] += 1


@njit(cache=True)
def _is_open(solid, ix, iy, iz, centre):
    """Say whether the line from a voxel to a point, in voxels, meets nothing solid."""
    nx, ny, nz = solid.shape
    dx, dy, dz = centre[0] - ix, centre[1] - iy, centre[2] - iz
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
