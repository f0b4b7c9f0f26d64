"""Space is free where views see it and find it free: pits that few can look into are filled."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.geometry.grid import voxel_from_world
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.surface.sky import is_open, rate_openness
from threedfs.threads import use_threads

_CLEAR = 1.0
"""Voxels before the depth of a view, from which it finds a place free."""
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
    narrow = rate_openness(solid, places, depth.fused.grid, up, depth.threads) < _OPEN
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


@njit(cache=True, parallel=True)
def _count(solid, index, rays, inverse_depth, spacing, centre, clear, count):
    for n in prange(len(index)):
        ix, iy, iz = index[n]
        # a discontinuity of 0: the nearest pixel's depth, as no mean of two surfaces says that a place is free
        distance, _, _, _ = measure_voxel(rays, ix, iy, iz, inverse_depth, spacing, 0.0)
        if distance > clear and is_open(solid, ix, iy, iz, centre):
            count[n] += 1
