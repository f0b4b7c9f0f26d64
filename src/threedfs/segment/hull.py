"""A field brought in line with the object's masks: carved where it sticks out of them, filled where it leaves gaps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from scipy import ndimage

from threedfs.geometry.grid import voxel_places
from threedfs.segment.lookup import nearest_pixels
from threedfs.segment.outline import depth_inside, draw_voxels
from threedfs.types import View, VoxelGrid

_STEPS = 30000
"""Steps of the hull's field from 0 to 1: whole numbers of two bytes, as there is one for each voxel and view."""
_RIM = 2
"""Half width of a gap up to which it is a rim, voxels."""
_REACH = 3
"""Farthest from the solid that a rim is filled, voxels."""


def fit_masks(
    sdf: np.ndarray,
    solid: np.ndarray,
    allowed: np.ndarray,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    grid: VoxelGrid,
    *,
    ramp: float,
    tolerance: float,
    least_views: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the field (nx, ny, nz) float32 in line with the masks, and which voxels (nx, ny, nz) bool it fills.

    Not in the paper. Outside the visual hull of the masks the field becomes positive. Inside, it becomes that of the
    hull at voxels that views show on gaps: pixels of the mask that no solid voxel projects on. A wide gap is filled by
    all of the hull behind it, a rim only by what is next to the solid: views from above alone leave a peak of the hull
    over a flat object, which a mask a little wider than the field does not call for. What the hull cannot tell, such as
    hollows, stays as fused.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    solid : (nx, ny, nz) bool
        The object before.
    allowed : (nx, ny, nz) bool
        Voxels that may be filled.
    masks : mapping of str to (H, W) bool
    views : mapping of str to View
    valid : mapping of str to (H, W) bool
        Pixels that show the scene; where they end is no outline of the object.
    grid : VoxelGrid
    ramp : float
        Distance from the hull at which its field is 1, voxels.
    tolerance : float
        Share of the views that may show a voxel of the hull outside their mask.
    least_views : int
        Views that show a voxel on a gap before it is filled.
    """
    places = np.flatnonzero(allowed)
    centres = voxel_places(grid, places)
    middle = np.append(centres[solid.reshape(-1)[places]].mean(axis=0) if solid.any() else centres.mean(axis=0), 1)
    covered = draw_voxels(solid, grid, views)
    distances = np.full((len(views), len(places)), -_STEPS, np.int16)
    gaps = []
    for rank, (name, view) in enumerate(views.items()):
        mask = masks[name]
        if not mask.any():
            continue  # it does not show the object at all
        row, column = nearest_pixels(view, centres)
        # world length of a pixel, per depth, in ramps of the hull's field
        share = 1 / (view.camera.fx * grid.spacing * ramp)
        outside = -depth_inside(mask | ~valid[name])
        _measure(centres, view.cam_from_world[2], row, column, outside, share, distances[rank])
        gap = mask & ~covered[name]
        footprint = max(1, int(np.ceil(view.camera.fx * grid.spacing / (view.cam_from_world[2] @ middle))))
        wide = cv2.morphologyEx(gap.astype(np.uint8), cv2.MORPH_OPEN, _disc(_RIM * footprint)) > 0
        voxels = _on(gap, row, column)
        gaps.append(_Gap(voxels, wide[row[voxels], column[voxels]]))
    allowance = min(int(tolerance * len(views)), len(views) - 1)
    distances.partition(len(views) - 1 - allowance, axis=0)
    hull = distances[len(views) - 1 - allowance] / np.float32(_STEPS)
    near = ndimage.distance_transform_edt(~solid).reshape(-1)[places] <= _REACH
    filled = _fill_gaps(gaps, hull < 0, near, least_views)
    fitted, fills = sdf.copy(), np.zeros(grid.shape, bool)
    values = fitted.reshape(-1)[places]
    values[filled] = np.minimum(values[filled], hull[filled])
    fitted.reshape(-1)[places] = np.maximum(values, hull)
    fills.reshape(-1)[places] = filled
    return fitted, fills


@dataclass(frozen=True)
class _Gap:
    """Voxels (N,) that a view shows on gaps of its mask, and whether on wide ones (N,)."""

    voxels: np.ndarray
    wide: np.ndarray


def _fill_gaps(gaps: list[_Gap], allowed: np.ndarray, near: np.ndarray, least_views: int) -> np.ndarray:
    """Say which voxels (N,) fill gaps that `least_views` views show them on: any gap if they are near, or wide ones."""
    any_gap, wide = np.zeros(len(allowed), np.int16), np.zeros(len(allowed), np.int16)
    for gap in gaps:
        any_gap[gap.voxels] += 1
        wide[gap.voxels] += gap.wide
    return allowed & (near & (any_gap >= least_views) | (wide >= least_views))


@njit(cache=True)
def _measure(centres, depth_from_world, row, column, outside, share, distances):
    """Write the distance from the hull of one mask, in steps, of voxels that have a pixel."""
    d = depth_from_world
    for n in range(len(row)):
        if row[n] >= 0:
            depth = d[0] * centres[n, 0] + d[1] * centres[n, 1] + d[2] * centres[n, 2] + d[3]
            level = outside[row[n], column[n]] * depth * share
            distances[n] = np.rint(min(max(level, -1.0), 1.0) * _STEPS)


@njit(cache=True)
def _on(mask, row, column):
    """Return the voxels, ascending, whose pixels are in a mask."""
    count = 0
    for n in range(len(row)):
        count += row[n] >= 0 and mask[row[n], column[n]]
    found = np.empty(count, np.int64)
    count = 0
    for n in range(len(row)):
        if row[n] >= 0 and mask[row[n], column[n]]:
            found[count] = n
            count += 1
    return found


def _disc(radius: int) -> np.ndarray:
    return cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
