"""Distance of voxels from the visual hull of the object's masks, some of which may be wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit

from threedfs.geometry.grid import voxel_places
from threedfs.segment.lookup import nearest_pixels
from threedfs.segment.outline import depth_inside
from threedfs.types import View, VoxelGrid


def measure_hull(
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    grid: VoxelGrid,
    allowed: np.ndarray,
    *,
    ramp: float,
    tolerances: Sequence[float],
) -> list[np.ndarray]:
    """Return the field of the masks' hull, (nx, ny, nz) float32 in [-1, 1], for each share of masks that may be wrong.

    A voxel's distance from the hull is the largest of its distances from the cones of the masks; with a tolerance,
    the largest but as many. A mask that shows nothing, and views that do not show a voxel, bound nothing.

    Parameters
    ----------
    masks, views, valid : mapping of str
        (H, W) bool, View, and (H, W) bool: pixels that show the scene; where they end is no outline.
    grid : VoxelGrid
    allowed : (nx, ny, nz) bool
        Voxels to measure; others are outside (1).
    ramp : float
        Distance at which the field is 1, voxels.
    tolerances : sequence of float
        Shares of the views whose masks show something.
    """
    places = np.flatnonzero(allowed)
    centres = voxel_places(grid, places)
    count = sum(masks[name].any() for name in views)
    ranks = [min(int(share * count), max(count - 1, 0)) for share in tolerances]
    largest = np.full((max(ranks) + 1, len(places)), -1, np.float32)
    for name, view in views.items():
        if not masks[name].any():
            continue
        row, column = nearest_pixels(view, centres)
        outside = -depth_inside(masks[name] | ~valid[name])
        # world length of a pixel, per depth, in ramps
        share = 1 / (view.camera.fx * grid.spacing * ramp)
        _insert(centres, view.cam_from_world[2], row, column, outside, share, largest)
    fields = []
    for rank in ranks:
        field = np.ones(grid.shape, np.float32)
        field.reshape(-1)[places] = largest[rank]
        fields.append(field)
    return fields


@njit(cache=True)
def _insert(centres, depth_from_world, row, column, outside, share, largest):
    """Put each voxel's distance from one cone, in ramps, in its place among the largest so far, in falling order."""
    d = depth_from_world
    for n in range(len(row)):
        if row[n] < 0:
            continue
        depth = d[0] * centres[n, 0] + d[1] * centres[n, 1] + d[2] * centres[n, 2] + d[3]
        value = min(max(outside[row[n], column[n]] * depth * share, -1.0), 1.0)
        for rank in range(len(largest)):
            if value > largest[rank, n]:
                value, largest[rank, n] = largest[rank, n], value
