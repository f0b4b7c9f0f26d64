"""A field brought in line with the object's masks: carved where it sticks out of them, filled where it leaves gaps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from threedfs.segment.lookup import find_pixels
from threedfs.segment.outline import draw_voxels
from threedfs.types import View, VoxelGrid

_AS_MANY = 0.7
"""Share of the most gaps that any voxel on a ray fills, from which a voxel is taken to fill them."""


def fit_masks(
    sdf: np.ndarray,
    solid: np.ndarray,
    allowed: np.ndarray,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    grid: VoxelGrid,
    *,
    ramp: float,
    tolerance: float,
    least_views: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the field (nx, ny, nz) float32 in line with the masks, and which voxels (nx, ny, nz) bool it fills.

    Not in the paper. Outside the visual hull of the masks the field becomes positive. Inside, it becomes that of the
    hull at voxels that views show on gaps: pixels of the mask that no solid voxel projects on. Of the voxels that could
    fill a gap those do that fill most others too: views from above alone leave a peak of the hull over a flat object,
    that a rim a pixel wide does not call for. What the hull cannot tell, such as hollows, stays as fused.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    solid : (nx, ny, nz) bool
        The object before.
    allowed : (nx, ny, nz) bool
        Voxels that may be filled.
    masks : mapping of str to (H, W) bool
    views : mapping of str to View
    grid : VoxelGrid
    ramp : float
        Distance from the hull at which its field is 1, voxels.
    tolerance : float
        Share of the views that may show a voxel of the hull outside their mask.
    least_views : int
        Views that show a voxel on a gap before it is filled.
    """
    places = np.flatnonzero(allowed)
    centres = grid.origin + grid.spacing * np.stack(np.unravel_index(places, grid.shape), axis=1)
    covered = draw_voxels(solid, grid, views)
    distances = np.full((len(views), len(places)), -np.inf, np.float16)
    gaps = []
    for rank, (name, view) in enumerate(views.items()):
        mask = masks[name]
        if not mask.any():
            continue  # it does not show the object at all
        outside = ndimage.distance_transform_edt(~mask) - ndimage.distance_transform_edt(mask)
        outside -= 0.5 * np.sign(outside)
        row, column, kept = find_pixels(view, centres)
        depth = centres[kept] @ view.cam_from_world[2, :3] + view.cam_from_world[2, 3]
        scale = depth / (view.camera.fx * grid.spacing * ramp)
        distances[rank, kept] = np.clip(outside[row, column] * scale, -1, 1)
        on_gap = (mask & ~covered[name])[row, column]
        footprint = view.camera.fx * grid.spacing / np.median(depth) if len(depth) else 1
        gaps.append(_Gap(np.flatnonzero(kept)[on_gap], row[on_gap], column[on_gap], mask.shape, footprint))
    allowance = min(int(tolerance * len(views)), len(views) - 1)
    hull = np.partition(distances, len(views) - 1 - allowance, axis=0)[len(views) - 1 - allowance].astype(np.float32)
    hull = np.maximum(hull, -1)
    filled = _fill_gaps(gaps, hull < 0, least_views)
    fitted, fills = sdf.copy(), np.zeros(grid.shape, bool)
    values = fitted.reshape(-1)[places]
    values[filled] = np.minimum(values[filled], hull[filled])
    fitted.reshape(-1)[places] = np.maximum(values, hull)
    fills.reshape(-1)[places] = filled
    return fitted, fills


@dataclass(frozen=True)
class _Gap:
    """Voxels (N,) that a view shows on gaps, their pixels there, the image's shape, and a voxel's size in pixels."""

    voxels: np.ndarray
    row: np.ndarray
    column: np.ndarray
    shape: tuple[int, int]
    footprint: float


def _fill_gaps(gaps: list[_Gap], allowed: np.ndarray, least_views: int) -> np.ndarray:
    """Say which voxels (N,) fill gaps: in `least_views` views they fill nearly as many as any on the same ray."""
    count = np.zeros(len(allowed), np.int16)
    for gap in gaps:
        count[gap.voxels] += 1
    count[~allowed] = 0
    chosen = np.zeros(len(allowed), np.int16)
    for gap in gaps:
        most = np.zeros(gap.shape, np.int16)
        np.maximum.at(most, (gap.row, gap.column), count[gap.voxels])
        most = ndimage.maximum_filter(most, 2 * int(np.ceil(gap.footprint / 2)) + 1)
        chosen[gap.voxels] += count[gap.voxels] >= _AS_MANY * most[gap.row, gap.column]
    return allowed & (chosen >= least_views)
