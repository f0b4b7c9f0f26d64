"""Gaps: what the object's masks show and no solid covers; a field brought in line with them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit

from threedfs.geometry.grid import voxel_places
from threedfs.geometry.near import find_near
from threedfs.hull.distance import measure_hull
from threedfs.read_ahead import map_ahead
from threedfs.segment.lookup import nearest_pixels
from threedfs.segment.outline import depth_inside, draw_voxels
from threedfs.types import View, VoxelGrid

_RIM = 2
"""Half width of a gap up to which it is a rim, voxels."""
_REACH = 3
"""Farthest from the solid that a rim is filled, voxels."""
_WELL = 1.5
"""Distance from a mask, voxels, beyond which it is no matter of its outline that a voxel is outside."""


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
    threads: int = 1,
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
    threads : int
        Cores used; the result does not depend on it.
    """
    (hull,) = measure_hull(masks, views, valid, grid, allowed, ramp=ramp, tolerances=(tolerance,), threads=threads)
    filled = find_gaps(solid, hull, allowed, masks, views, grid, least_views, threads=threads)
    fitted = np.where(filled, np.minimum(sdf, hull), sdf)
    return np.where(allowed, np.maximum(fitted, hull), fitted).astype(np.float32), filled


def find_gaps(
    solid: np.ndarray,
    hull: np.ndarray,
    allowed: np.ndarray,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    grid: VoxelGrid,
    least_views: int,
    odds: float = 0.0,
    threads: int = 1,
) -> np.ndarray:
    """Return the voxels (nx, ny, nz) bool of the hull that views show on gaps; as `fit_masks`.

    Parameters
    ----------
    hull : (nx, ny, nz) float32
        The masks' hull, negative inside.
    odds : float
        How many views must show a voxel on a gap for each that shows it well outside of its mask.
    threads : int
        Changes no result.
    """
    asked = allowed & (hull < 0)
    places = np.flatnonzero(asked)
    centres = voxel_places(grid, places)
    filled = np.zeros(grid.shape, bool)
    if not len(places):
        return filled
    own = np.flatnonzero(allowed & solid)
    middle = np.append((voxel_places(grid, own) if len(own) else centres).mean(axis=0), 1)
    covered = draw_voxels(solid, grid, views, threads)
    gaps, outside = [], np.zeros(len(places), np.int32)

    def look(name: str) -> tuple[_Gap, np.ndarray] | None:
        """Return the gap that a view shows, and the voxels that it shows well outside of its mask, if it counts."""
        view, gap = views[name], masks[name] & ~covered[name]
        if not gap.any() and (odds <= 0 or not masks[name].any()):
            return None
        row, column = nearest_pixels(view, centres)
        footprint = max(1, int(np.ceil(view.camera.fx * grid.spacing / (view.cam_from_world[2] @ middle))))
        away = np.zeros(0, np.int64)
        if odds > 0:
            away = _find_outside(masks[name], row, column, footprint)
        wide = cv2.morphologyEx(gap.astype(np.uint8), cv2.MORPH_OPEN, _disc(_RIM * footprint)) > 0
        voxels = _on(gap, row, column)
        return _Gap(voxels, wide[row[voxels], column[voxels]]), away

    for found in map_ahead(look, views, threads=threads):
        if found is not None:
            gaps.append(found[0])
            outside[found[1]] += 1
    near = find_near(solid, _REACH, asked, threads).reshape(-1)[places]
    filled.reshape(-1)[places] = _fill_gaps(gaps, near, np.maximum(least_views, odds * outside))
    return filled


@dataclass(frozen=True)
class _Gap:
    """Voxels (N,) that a view shows on gaps of its mask, and whether on wide ones (N,)."""

    voxels: np.ndarray
    wide: np.ndarray


def count_outside(
    places: np.ndarray, views: Mapping[str, View], masks: Mapping[str, np.ndarray], spacing: float
) -> np.ndarray:
    """Return how many masks show world points well outside: farther than 1.5 voxels from what they show.

    Parameters
    ----------
    places : (N, 3) float64
        World, one at least.
    views, masks : mapping of str
        View, and (H, W) bool.
    spacing : float
        Edge of a voxel, scene units.

    Returns
    -------
    (N,) int32
    """
    outside = np.zeros(len(places), np.int32)
    for name, view in views.items():
        row, column = nearest_pixels(view, places)
        footprint = view.camera.fx * spacing / (view.cam_from_world[2] @ np.append(places.mean(axis=0), 1))
        outside[_find_outside(masks[name], row, column, footprint)] += 1
    return outside


def _find_outside(mask: np.ndarray, row: np.ndarray, column: np.ndarray, footprint: float) -> np.ndarray:
    """Return the points, ascending, that a mask (H, W) bool shows well outside; a voxel is `footprint` pixels wide."""
    return _on(depth_inside(mask) < -_WELL * footprint, row, column)


def _fill_gaps(gaps: list[_Gap], near: np.ndarray, least_views: np.ndarray) -> np.ndarray:
    """Say which voxels (N,) fill gaps that `least_views` (N,) show them on: any gap if they are near, or wide ones."""
    any_gap, wide = np.zeros(len(near), np.int16), np.zeros(len(near), np.int16)
    for gap in gaps:
        any_gap[gap.voxels] += 1
        wide[gap.voxels] += gap.wide
    return near & (any_gap >= least_views) | (wide >= least_views)


@njit(nogil=True, cache=True)
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
