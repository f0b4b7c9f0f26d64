"""Voxels near a set of voxels."""

from __future__ import annotations

import numpy as np
from numba import njit, prange

from threedfs.checks import check_shape
from threedfs.threads import use_threads


def find_near(voxels: np.ndarray, radius: float, among: np.ndarray, threads: int = 1) -> np.ndarray:
    """Return which voxels of `among` are no farther than `radius` voxels from a set of voxels.

    For a radius of a few voxels: its time grows with the cube of the radius. A distance transform takes some 48 bytes
    a voxel, this holds nothing but its result.

    Parameters
    ----------
    voxels : (nx, ny, nz) bool
        The set.
    among : (nx, ny, nz) bool
        Voxels to test.
    radius : float
        In voxels.
    threads : int
        Changes no result.

    Returns
    -------
    (nx, ny, nz) bool

    Raises
    ------
    UserError
        If the two have different shapes.
    """
    check_shape(among, voxels.shape, "voxels to test")
    use_threads(threads)
    near = np.zeros(voxels.shape, np.bool_)
    _find(voxels, _ball(radius), among, near)
    return near


def _ball(radius: float) -> np.ndarray:
    """Return the offsets (N, 3) int64 that are no longer than a radius, the shortest first."""
    reach = int(radius)
    offsets = np.argwhere(np.ones((2 * reach + 1,) * 3, bool)) - reach
    length = np.sqrt((offsets**2).sum(axis=1))
    return offsets[np.argsort(length, kind="stable")][: np.count_nonzero(length <= radius)]


@njit(cache=True, parallel=True)
def _find(voxels, offsets, among, near):
    nx, ny, nz = voxels.shape
    for ix in prange(nx):
        for iy in range(ny):
            for iz in range(nz):
                if not among[ix, iy, iz]:
                    continue
                for n in range(len(offsets)):
                    jx, jy, jz = ix + offsets[n, 0], iy + offsets[n, 1], iz + offsets[n, 2]
                    if 0 <= jx < nx and 0 <= jy < ny and 0 <= jz < nz and voxels[jx, jy, jz]:
                        near[ix, iy, iz] = True
                        break
