"""The object in the coarse field of the scene: enough to know where images show it."""

from __future__ import annotations

import numpy as np
from skimage.morphology import convex_hull_image

from threedfs.geometry.grid import cover_box, cut_grid, voxel_centres, voxel_index
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


def fill_notches(grid: VoxelGrid, solid: np.ndarray, support: Support) -> tuple[VoxelGrid, np.ndarray]:
    """Return a solid with the notches that it hangs over, and the grid of that, which stands on the plane.

    Not in the paper. The plane's mirror image carves the lower part of an upright face, between its sides and under an
    edge or a lid that are still there. A notch is what lies below the solid, and in the convex hull of what is solid at
    its own height.

    Parameters
    ----------
    grid : VoxelGrid
    solid : (nx, ny, nz) bool
        See `mark_coarse`.
    support : Support

    Returns
    -------
    standing : VoxelGrid
        Over the object's box, of the same spacing.
    filled : (mx, my, mz) bool
    """
    extent = support.box.high - support.box.low
    standing = cover_box(support.box, int(np.ceil(extent.max() / grid.spacing)))
    index, held = voxel_index(grid, voxel_centres(standing).reshape(-1, 3))
    filled = held.reshape(standing.shape)
    filled[filled] = solid[tuple(index.T)]
    under = np.logical_or.accumulate(filled[:, :, ::-1], axis=2)[:, :, ::-1]
    for level in np.flatnonzero(filled.any(axis=(0, 1))):
        filled[:, :, level] |= under[:, :, level] & convex_hull_image(filled[:, :, level])
    return standing, filled & (height_above(support.plane, standing) > _CLEARANCE * standing.spacing)
