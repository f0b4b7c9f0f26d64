"""What lies well inside the hull of masks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.grid import voxel_index
from threedfs.hull.distance import measure_hull
from threedfs.hull.grid import may_be_hull
from threedfs.locate.height import height_above
from threedfs.types import Plane, View, VoxelGrid


@dataclass(frozen=True)
class HullInside:
    """The voxels well inside a hull.

    Attributes
    ----------
    grid : VoxelGrid
    deep : (nx, ny, nz) bool
        Those at least so deep inside.
    """

    grid: VoxelGrid
    deep: np.ndarray

    def holds(self, points: np.ndarray) -> np.ndarray:
        """Say which world points (N, 3) lie there, (N,) bool; those outside of the grid do not."""
        index, kept = voxel_index(self.grid, points)
        found = np.zeros(len(points), bool)
        found[kept] = self.deep[tuple(index.T)]
        return found


def find_inside(
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    grid: VoxelGrid,
    plane: Plane,
    *,
    depth: float,
    tolerance: float,
    threads: int = 1,
) -> HullInside:
    """Return what lies at least so deep inside the hull of masks.

    Parameters
    ----------
    masks, views, valid
        As `measure_hull` takes them.
    grid : VoxelGrid
    plane : Plane
        The support plane; it bounds nothing, and the hull goes on for two voxels below it.
    depth : float
        Voxels.
    tolerance : float
        Share of the masks that may be wrong.
    threads : int
        Cores used; the result does not depend on it.
    """
    above = may_be_hull(height_above(plane, grid), grid)
    (hull,) = measure_hull(masks, views, valid, grid, above, ramp=depth, tolerances=(tolerance,), threads=threads)
    return HullInside(grid, hull <= -1)
