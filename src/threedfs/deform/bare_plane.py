"""The support surface as evidence: where nothing stands on it, the field's zero level is known."""

from __future__ import annotations

import numpy as np

from threedfs.deform.evidence import SurfaceSamples, sample_field
from threedfs.object.field import height_above
from threedfs.types import Plane, VoxelGrid

_FREE = 3
"""A place is bare if the field is free from the height of a bump to so many times it."""


def draw_plane(
    sdf: np.ndarray,
    seen: np.ndarray,
    grid: VoxelGrid,
    plane: Plane,
    *,
    height: float,
    reach: float,
    trust: float,
    count: int,
    rng: np.random.Generator,
) -> SurfaceSamples:
    """Draw points on the support plane over which the field rises no higher than a bump would.

    Differs from the paper, whose correction knows surface points only: in shadows and on plain tables there are none,
    and what depth raises there stays a part of the object.

    Parameters
    ----------
    sdf, seen : (nx, ny, nz)
        The field and the number of views that see each voxel.
    grid : VoxelGrid
    plane : Plane
        The support surface.
    height : float
        Of the highest bump, scene units: what reaches higher, or hides the space above, stands on the plane.
    reach : float
        Largest |sdf| at a point; at 1 the field is not known.
    trust : float
        Of each point.
    count : int
        Fewer where fewer voxels of the plane are bare.
    rng : numpy.random.Generator
    """
    if count == 0:
        return SurfaceSamples(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    rise = height_above(plane, grid)
    layer = (rise > -0.5 * grid.spacing) & (rise <= 0.5 * grid.spacing)
    voxels = np.asarray(grid.origin) + grid.spacing * np.argwhere(layer)
    xyz = voxels - rise[layer][:, None] * plane.normal
    known = (seen > 0).astype(np.float32)
    value = sample_field(sdf, grid, xyz)
    kept = (sample_field(known, grid, xyz) > 0.5) & (np.abs(value) <= reach) & (np.abs(value) < 1)
    for level in np.arange(height, _FREE * height + grid.spacing / 2, grid.spacing):
        above = xyz + level * plane.normal
        kept &= (sample_field(sdf, grid, above) > 0) & (sample_field(known, grid, above) > 0.5)
    chosen = rng.permutation(np.flatnonzero(kept))[:count]
    return SurfaceSamples(xyz[chosen], value[chosen], np.full(len(chosen), trust))
