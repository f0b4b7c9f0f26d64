"""Heights over the support plane, and what of the object they leave out."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import voxel_index, world_from_index
from threedfs.types import Plane, VoxelGrid


def height_above(plane: Plane, grid: VoxelGrid) -> np.ndarray:
    """Return the signed distance of every voxel from the plane, (nx, ny, nz) float32, scene units."""
    heights = [grid.axis(d) * share for d, share in enumerate(grid.axes @ plane.normal)]
    return (heights[0][:, None, None] + heights[1][:, None] + heights[2] + plane.offset).astype(np.float32)


def least_height(clearance: float, noise_clearance: float, spacing: float, noise: float) -> float:
    """Return the height over the plane from which solids count, scene units.

    Parameters
    ----------
    clearance : float
        In voxels.
    noise_clearance : float
        In standard deviations of the support surface from its plane.
    spacing, noise : float
        Of the voxels, and that deviation, scene units.
    """
    return max(clearance * spacing, noise_clearance * noise)


def known_above(seen: np.ndarray, height: np.ndarray, least: float) -> np.ndarray:
    """Return where solids count, (nx, ny, nz) bool: voxels that views see, higher over the plane than `least`.

    Parameters
    ----------
    seen : (nx, ny, nz) uint8
        Number of views that see each voxel.
    height : (nx, ny, nz) float32
        `height_above`.
    least : float
        `least_height`.
    """
    return (seen > 0) & (height > least)


def add_foot(voxels: np.ndarray, height: np.ndarray, grid: VoxelGrid, plane: Plane, clearance: float) -> np.ndarray:
    """Add to an object found above the clearance the voxels between it and the plane, straight below it.

    Parameters
    ----------
    voxels : (nx, ny, nz) bool
        The object, all of it higher than `clearance`.
    height : (nx, ny, nz) float32
        Above the plane.
    grid : VoxelGrid
    plane : Plane
    clearance : float
        Scene units.

    Returns
    -------
    (nx, ny, nz) bool
    """
    # Heights of the voxels just above the clearance differ by up to a voxel's diagonal: look there.
    low = np.argwhere((height <= clearance) & (height > -grid.spacing))
    lift = clearance + 0.87 * grid.spacing - height[tuple(low.T)]
    points = world_from_index(grid, low) + lift[:, None] * plane.normal
    above, kept = voxel_index(grid, points)
    owned = voxels.copy()
    owned[tuple(low[kept].T)] |= voxels[tuple(above.T)]
    return owned
