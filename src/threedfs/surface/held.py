"""What depth holds against the masks: thin parts that some of them lack."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit, prange
from scipy.ndimage import binary_dilation, maximum_filter
from scipy.spatial import cKDTree

from threedfs.fusion.view_sdf import invert_depth, measure_voxel, relate
from threedfs.geometry.grid import voxel_places
from threedfs.hull.gaps import count_outside
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.threads import use_threads
from threedfs.types import View

_NEAR = 1.0
"""Voxels from a voxel within which a depth map has the surface there."""
_LEAST_VIEWS = 4
"""Depth maps that hold a place, where the share of all of them is fewer."""
_MOST_OUTSIDE = 0.75
"""Share of the masks that may show a place well outside which depth holds."""
_BELIEVED = 0.5
"""Trust from which a depth map is asked."""


def release_bound(
    bound: np.ndarray,
    height: np.ndarray,
    depth: ConfirmedDepth,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    *,
    held_share: float,
    held_height: float,
) -> np.ndarray:
    """Return the bound (nx, ny, nz) float32 without what depth holds against the masks.

    Not in the paper. Where a horn is before a newspaper, some masks lack it, and the hull of all that bounds the object
    would cut it off; but many depth maps have its surface. Near the support surface they have that, so there the masks
    decide, and they do where too many show a place well outside: another thing may stand there.

    Parameters
    ----------
    bound : (nx, ny, nz) float32
        The masks' hull that nothing leaves, negative inside.
    height : (nx, ny, nz) float
        Of the voxels above the support plane, scene units.
    depth : ConfirmedDepth
    masks, views : mapping of str
        (H, W) bool, and View.
    held_share : float
        Of the depth maps, which must be trusted and have the surface within a voxel of a place, or beside it, to hold
        that and what lies behind it; 0 for nothing held.
    held_height : float
        Height from which depth holds anything, voxels.
    """
    field, grid = depth.fused.result()[0], depth.fused.grid
    lost = (field < 0) & (bound > 0) & (height > held_height * grid.spacing)
    places = np.flatnonzero(lost)
    if not held_share or not len(places):
        return bound
    use_threads(depth.threads)
    index, count = np.argwhere(lost), np.zeros(grid.shape, np.int32)
    for name, view in depth.views.items():
        inverse = invert_depth(depth.read(name))
        _count(index, relate(grid, view), inverse, depth.trust[name], grid.spacing, count)
    shown = [name for name in views if masks[name].any()]
    outside = count_outside(voxel_places(grid, places), {name: views[name] for name in shown}, masks, grid.spacing)
    held = maximum_filter(count, 3).reshape(-1)[places] >= max(_LEAST_VIEWS, round(held_share * len(depth.views)))
    held &= outside <= _MOST_OUTSIDE * len(shown)
    skin = binary_dilation(field >= 0).reshape(-1)[places]
    held = _follow_skin(index, skin, held) if skin.any() else np.zeros_like(held)
    released = bound.copy()
    released.reshape(-1)[places[held]] = field.reshape(-1)[places[held]]
    return released


def _follow_skin(index: np.ndarray, skin: np.ndarray, held: np.ndarray) -> np.ndarray:
    """Return which voxels (N, 3) are held: of the skin those that are, and what is nearest to these."""
    _, nearest = cKDTree(index[skin]).query(index)
    return held[skin][nearest]


@njit(cache=True, parallel=True)
def _count(index, rays, inverse_depth, trust, spacing, count):
    """Count the voxels (N, 3) within reach of a trusted depth map's surface."""
    for n in prange(len(index)):
        x, y, z = index[n]
        distance, _, row, column = measure_voxel(rays, x, y, z, inverse_depth, spacing, 0.0)
        if abs(distance) <= _NEAR and trust[row, column] > _BELIEVED:
            count[x, y, z] += 1
