"""The plain maximum of the views' signed distances (3.3, Eq. 13)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit, prange

from threedfs.checks import check_shape
from threedfs.fusion.softmax import UNSEEN
from threedfs.fusion.view_fusion import ViewFusion
from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.types import View, VoxelGrid


class HardMaximum(ViewFusion):
    """Fuses the signed distances of views into their maximum, holding one view at a time.

    Right where all depth maps are; one view whose surface lies too far back carves the object away.

    Differs from the paper as `SoftMaximum` always does: the maximum is over the views that see a voxel, and depth is
    not interpolated across its discontinuities.

    Parameters
    ----------
    grid : VoxelGrid
    clip_distance : float
        Distance from the surface at which votes are clipped, scene units (mu).
    discontinuity : float
        Relative step of inverse depth between neighbouring pixels above which they lie on different surfaces.
    threads : int
        Cores used; the result does not depend on it.
    """

    def __init__(self, grid: VoxelGrid, clip_distance: float, *, discontinuity: float, threads: int = 1) -> None:
        super().__init__(grid, threads)
        self._most = np.full(grid.shape, -np.inf, np.float32)
        self._seen = np.zeros(grid.shape, np.uint8)
        self._settings = (float(clip_distance), float(discontinuity))

    def weigh(self, view: View, depth: np.ndarray) -> tuple:
        """Return what a view with a depth map (H, W), NaN where missing, has to say on every voxel it sees.

        Raises
        ------
        UserError
            If the map has not the shape of the view's images.
        """
        check_shape(depth, view.camera.shape, f"depth of view {view.name}")
        return relate(self.grid, view), invert_depth(depth)

    def count(self, *ballot: Any) -> None:
        """Raise the field to the votes of one view."""
        _raise_to_view(self._most, self._seen, *ballot, *self._settings)

    def result(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the field and the number of views that vote, as `SoftMaximum.result`."""
        return np.where(self._seen > 0, self._most, np.float32(UNSEEN)), self._seen


@njit(cache=True, parallel=True)
def _raise_to_view(most, seen, rays, inverse_depth, clip_distance, discontinuity):
    nx, ny, nz = seen.shape
    for ix in prange(nx):
        for iy in range(ny):
            for iz in range(nz):
                distance = measure_voxel(rays, ix, iy, iz, inverse_depth, clip_distance, discontinuity)[0]
                if math.isnan(distance):
                    continue
                most[ix, iy, iz] = max(most[ix, iy, iz], min(1.0, max(-1.0, distance)))
                if seen[ix, iy, iz] < 255:
                    seen[ix, iy, iz] += 1
