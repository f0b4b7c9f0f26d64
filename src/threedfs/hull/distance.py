"""Distance of voxels from the visual hull of the object's masks, some of which may be wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numba import njit, prange

from threedfs.geometry.grid import voxel_places
from threedfs.read_ahead import map_ahead
from threedfs.segment.lookup import find_pixel
from threedfs.segment.outline import depth_inside
from threedfs.threads import use_threads
from threedfs.types import View, VoxelGrid

_AT_ONCE = 1 << 20
"""Voxels whose distances from all cones are held at one time."""


def measure_hull(
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    grid: VoxelGrid,
    allowed: np.ndarray,
    *,
    ramp: float,
    tolerances: Sequence[float],
    threads: int = 1,
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
    threads : int
        Cores used; the result does not depend on it.
    """
    places = np.flatnonzero(allowed)
    shown = [name for name in views if masks[name].any()]
    count = len(shown)
    ranks = [min(int(share * count), max(count - 1, 0)) for share in tolerances]
    use_threads(threads)
    outside = list(map_ahead(lambda name: -depth_inside(masks[name] | ~valid[name]), shown, threads=threads))
    fields = [np.ones(grid.shape, np.float32) for _ in ranks]
    for part in np.split(places, range(_AT_ONCE, len(places), _AT_ONCE)):
        centres = voxel_places(grid, part)
        largest = np.full((len(part), max(ranks) + 1), -1, np.float32)
        for name, distance in zip(shown, outside, strict=True):
            view = views[name]
            # world length of a pixel, per depth, in ramps
            share = 1 / (view.camera.fx * grid.spacing * ramp)
            _insert(centres, view.px_from_world, view.cam_from_world[2], distance, share, largest)
        for field, rank in zip(fields, ranks, strict=True):
            field.reshape(-1)[part] = largest[:, rank]
    return fields


@njit(nogil=True, cache=True, parallel=True, error_model="numpy")
def _insert(centres, px_from_world, depth_from_world, outside, share, largest):
    """Put each voxel's distance from one cone, in ramps, in its place among the largest so far, in falling order."""
    d = depth_from_world
    last = largest.shape[1] - 1
    for n in prange(len(centres)):
        if largest[n, last] >= 1:  # no cone tells more of it
            continue
        x, y, z = centres[n, 0], centres[n, 1], centres[n, 2]
        row, column = find_pixel(x, y, z, px_from_world, outside.shape[0], outside.shape[1])
        if row < 0:
            continue
        depth = d[0] * x + d[1] * y + d[2] * z + d[3]
        value = min(max(outside[row, column] * depth * share, -1.0), 1.0)
        if value <= largest[n, last]:
            continue
        for rank in range(last + 1):
            if value > largest[n, rank]:
                value, largest[n, rank] = largest[n, rank], value
