"""Voxels near a set of voxels."""

from __future__ import annotations

import numba
import numpy as np
from numba import njit, prange


def find_near(voxels: np.ndarray, radius: float, among: np.ndarray, threads: int = 1) -> np.ndarray:
    """Return which voxels of `among` are no farther than `radius` voxels from a set of voxels.

    For a radius of a few voxels; it holds nothing but its result, where a distance transform holds twelve numbers for
    each voxel.

    Parameters
    ----------
    voxels, among : (nx, ny, nz) bool
    radius : float
    threads : int
        Changes no result.

    Returns
    -------
    (nx, ny, nz) bool
    """
    numba.set_num_threads(max(1, min(threads, numba.config.NUMBA_NUM_THREADS)))
    near = np.zeros(voxels.shape, np.bool_)
    _find(voxels, _ball(radius), among, near)
    return near


def _ball(radius: float) -> np.ndarray:
    """Return the steps (N, 3) int64 that are no longer than a radius, the shortest first."""
    reach = int(radius)
    steps = np.argwhere(np.ones((2 * reach + 1,) * 3, bool)) - reach
    length = np.sqrt((steps**2).sum(axis=1))
    return steps[np.argsort(length, kind="stable")][: np.count_nonzero(length <= radius)]


@njit(cache=True, parallel=True)
def _find(voxels, steps, among, near):
    nx, ny, nz = voxels.shape
    for ix in prange(nx):
        for iy in range(ny):
            for iz in range(nz):
                if not among[ix, iy, iz]:
                    continue
                for n in range(len(steps)):
                    jx, jy, jz = ix + steps[n, 0], iy + steps[n, 1], iz + steps[n, 2]
                    if 0 <= jx < nx and 0 <= jy < ny and 0 <= jz < nz and voxels[jx, jy, jz]:
                        near[ix, iy, iz] = True
                        break
