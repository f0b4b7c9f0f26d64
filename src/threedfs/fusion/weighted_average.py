"""Truncated signed distances averaged over the views, the fusion of KinectFusion: the paper's baseline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit, prange

from threedfs.checks import check_shape
from threedfs.fusion.softmax import UNSEEN, facing_cosine
from threedfs.fusion.view_fusion import ViewFusion
from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.types import View, VoxelGrid

_LEAST_WEIGHT = 0.05
"""Of a vote whose surface is seen edge on: it counts where there is no other."""


class WeightedAverage(ViewFusion):
    """Fuses truncated signed distances of views into their weighted mean, holding one view at a time.

    A view says nothing of a voxel farther behind its surface than the truncation; in front of it votes are clipped.
    A vote weighs by the cosine between the surface's normal and the ray; KinectFusion also divides by the distance,
    which hardly differs between views around one object, and measures along the depth axis instead of the ray.

    A voxel that some view looks towards and all have only behind their surfaces is taken for solid (-1), so that the
    inside of the object is not a hollow: the baseline is to give a closed mesh like the others.

    Parameters
    ----------
    grid : VoxelGrid
    truncation : float
        Scene units.
    discontinuity : float
        Relative step of inverse depth between neighbouring pixels above which they lie on different surfaces.
    threads : int
        Cores used; the result does not depend on it.

    References
    ----------
    Newcombe et al., KinectFusion: real-time dense surface mapping and tracking, 2011, Eqs. 6 to 11.
    """

    def __init__(self, grid: VoxelGrid, truncation: float, *, discontinuity: float, threads: int = 1) -> None:
        super().__init__(grid, threads)
        self._weighted = np.zeros(grid.shape)
        self._weight = np.zeros(grid.shape)
        self._seen = np.zeros(grid.shape, np.uint8)
        self._settings = (float(truncation), float(discontinuity))

    def weigh(self, view: View, depth: np.ndarray) -> tuple:
        """Return what a view with a depth map (H, W), NaN where missing, has to say on every voxel it sees.

        Raises
        ------
        UserError
            If the map has not the shape of the view's images.
        """
        check_shape(depth, view.camera.shape, f"depth of view {view.name}")
        facing = np.maximum(facing_cosine(view.camera, depth), _LEAST_WEIGHT)
        return relate(self.grid, view), invert_depth(depth), facing

    def count(self, *ballot: Any) -> None:
        """Add the votes of one view to the weighted sums."""
        _average_view(self._weighted, self._weight, self._seen, *ballot, *self._settings)

    def result(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the field in units of the truncation, and the views that look towards a voxel."""
        sdf = np.where(self._seen > 0, np.float32(-1), np.float32(UNSEEN))
        np.divide(self._weighted, self._weight, out=sdf, where=self._weight > 0, casting="same_kind")
        return sdf, self._seen


@njit(cache=True, parallel=True)
def _average_view(weighted, weight, seen, rays, inverse_depth, facing, truncation, discontinuity):
    nx, ny, nz = seen.shape
    for ix in prange(nx):
        for iy in range(ny):
            for iz in range(nz):
                distance, _, row, column = measure_voxel(rays, ix, iy, iz, inverse_depth, truncation, discontinuity)
                if math.isnan(distance):
                    continue
                if seen[ix, iy, iz] < 255:
                    seen[ix, iy, iz] += 1
                if distance >= -1.0:
                    vote = facing[row, column]
                    weighted[ix, iy, iz] += vote * min(1.0, distance)
                    weight[ix, iy, iz] += vote
