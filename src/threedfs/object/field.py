"""The object's own signed distance field: cut by the support plane, everything else made empty."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import voxel_index
from threedfs.types import Plane, VoxelGrid


def height_above(plane: Plane, grid: VoxelGrid) -> np.ndarray:
    """Return the signed distance of every voxel from the plane, (nx, ny, nz) float32, scene units."""
    heights = [grid.axis(d) * plane.normal[d] for d in range(3)]
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
    points = grid.origin + grid.spacing * low + lift[:, None] * plane.normal
    above, kept = voxel_index(grid, points)
    owned = voxels.copy()
    owned[tuple(low[kept].T)] |= voxels[tuple(above.T)]
    return owned


def mask_field(sdf: np.ndarray, owned: np.ndarray, height: np.ndarray, spacing: float) -> np.ndarray:
    """Return the field of the object alone, (nx, ny, nz) float32, negative inside it and nowhere else (Sec. 3.5).

    Outside the object the field is set to 1 where it is negative. The support plane cuts the object: below, the field
    is the distance to the plane in voxels.

    Differs from the paper: outside the object the field stays where it is positive, so that the zero level keeps
    its place between voxels; the paper sets all of it to 1, which moves the surface to the voxel centres. The
    paper has no cut by the plane, its labels end there. The mesh smoothing of Section 3.5 is not applied here.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    owned : (nx, ny, nz) bool
        Voxels of the object.
    height : (nx, ny, nz) float32
        Above the plane, scene units.
    spacing : float
        Edge of a voxel, scene units.
    """
    cut = np.maximum(sdf, np.clip(-height / spacing, -1, 1))
    return np.where((cut < 0) & ~owned, np.float32(1), cut).astype(np.float32)
