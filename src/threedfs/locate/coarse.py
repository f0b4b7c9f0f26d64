"""The object in the coarse field of the scene: enough to know where images show it."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import cut_grid, voxel_centres
from threedfs.locate.height import height_above
from threedfs.types import Support, VoxelGrid

_CLEARANCE = 1.0
"""Height over the plane from which solids count, voxels: below it are the plane's own votes."""


def mark_coarse(grid: VoxelGrid, sdf: np.ndarray, support: Support) -> tuple[VoxelGrid, np.ndarray]:
    """Return the part of a grid around the object's box, and what is solid there over the plane, (nx, ny, nz) bool.

    What no view sees is not solid.

    Parameters
    ----------
    grid : VoxelGrid
    sdf : (mx, my, mz) float32
        The scene's field, negative in solids.
    support : Support
    """
    around, part = cut_grid(grid, support.box)
    along = voxel_centres(around) @ support.box.axes.T
    inside = ((along >= support.box.low) & (along <= support.box.high)).all(axis=-1)
    return around, inside & (sdf[part] < 0) & (height_above(support.plane, around) > _CLEARANCE * grid.spacing)
