"""A field brought in line with the object's masks: carved where it sticks out of them, filled where it leaves gaps."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy import ndimage

from threedfs.segment.lookup import find_pixels
from threedfs.segment.outline import draw_voxels
from threedfs.types import View, VoxelGrid


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
    hull at voxels that views show on gaps: pixels of the mask that no solid voxel projects on. What the hull cannot
    tell, such as hollows, stays as fused.

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
    gaps = np.zeros(len(places), np.int16)
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
        gaps[kept] += (mask & ~covered[name])[row, column]
    allowance = min(int(tolerance * len(views)), len(views) - 1)
    hull = np.partition(distances, len(views) - 1 - allowance, axis=0)[len(views) - 1 - allowance].astype(np.float32)
    hull = np.maximum(hull, -1)
    filled = (gaps >= least_views) & (hull < 0)
    fitted, fills = sdf.copy(), np.zeros(grid.shape, bool)
    values = fitted.reshape(-1)[places]
    values[filled] = np.minimum(values[filled], hull[filled])
    fitted.reshape(-1)[places] = np.maximum(values, hull)
    fills.reshape(-1)[places] = filled
    return fitted, fills
