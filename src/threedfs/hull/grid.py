"""A grid around the hull of masks alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from threedfs.geometry.grid import cover_box
from threedfs.hull.distance import measure_hull
from threedfs.locate.height import height_above
from threedfs.types import Box, Plane, View, VoxelGrid

_COARSE = 80
"""Voxels along the longest side of the object's box, of the grid on which the hull is found first."""
_MARGIN = 3.0
"""Voxels of that grid around the hull."""
_DEEPEST = -2.0
"""Voxels above the support plane from which the hull is measured."""


def lay_grid(
    box: Box,
    plane: Plane,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    tolerance: float,
    longest_side: int,
) -> VoxelGrid:
    """Return a grid around the hull of the masks: the object's box has room around it that needs no voxels.

    Parameters
    ----------
    box : Box
        The object's, scene units.
    plane : Plane
        What it stands on, scene units.
    masks, views, valid
        As `measure_hull` takes them.
    tolerance : float
        Share of the masks that may be wrong.
    longest_side : int
        Voxels along the longest side.
    """
    coarse = cover_box(box, _COARSE)
    above = may_be_hull(height_above(plane, coarse), coarse)
    (hull,) = measure_hull(masks, views, valid, coarse, above, ramp=1.0, tolerances=(tolerance,))
    return cover_box(enclose_hull(hull, coarse, _MARGIN), longest_side)


def may_be_hull(height: np.ndarray, grid: VoxelGrid) -> np.ndarray:
    """Say which voxels (nx, ny, nz) bool lie high enough over the support plane, by their height, scene units."""
    return height > _DEEPEST * grid.spacing


def enclose_hull(field: np.ndarray, grid: VoxelGrid, margin: float) -> Box:
    """Return the box along a grid's axes around the voxels at which a hull's field (nx, ny, nz) is negative.

    It reaches farther by `margin` voxels on each side, but not out of the grid; of an empty hull it is the whole grid.
    """
    index = np.argwhere(field < 0)
    last = np.array(grid.shape) - 1
    low, high = (index.min(axis=0), index.max(axis=0)) if len(index) else (np.zeros(3), last)
    start = grid.axes @ grid.origin
    ends = (np.maximum(low - margin, -0.5), np.minimum(high + margin, last + 0.5))
    return Box(grid.axes, *(start + grid.spacing * end for end in ends))
