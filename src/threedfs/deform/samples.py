"""Where the correction of a field is held, and where it may act (Section 3.3.2)."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.grid import voxel_places
from threedfs.types import VoxelGrid

ANCHOR_LEVEL = 0.9
_LEVEL_BAND = 0.05
"""A voxel lies on a level set if its value is so near the level: at ten voxels a clip distance half a voxel."""


def draw_anchors(
    sdf: np.ndarray, seen: np.ndarray, grid: VoxelGrid, count: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw points on the level sets 0.9 and -0.9 of a field, where it is not to change.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32
    seen : (nx, ny, nz) uint8
        Voxels that no view sees have no level.
    grid : VoxelGrid
    count : int
        Of each level set; fewer where it has fewer voxels.
    rng : numpy.random.Generator

    Returns
    -------
    (M, 3) float64, world

    Notes
    -----
    An object thinner than the clip distance has no level -0.9: then its inside is held by its surface points alone.
    """
    levels = (sdf - ANCHOR_LEVEL, sdf + ANCHOR_LEVEL)
    drawn = [_draw(np.flatnonzero((np.abs(level) < _LEVEL_BAND) & (seen > 0)), count, rng) for level in levels]
    return voxel_places(grid, np.concatenate(drawn))


def draw_controls(sdf: np.ndarray, grid: VoxelGrid, count: int, near: float, rng: np.random.Generator) -> np.ndarray:
    """Draw the centres of the basis functions: half where |sdf| < `near`, half elsewhere; (count, 3) float64, world."""
    close = np.abs(sdf) < near
    inner = _draw(np.flatnonzero(close), count // 2, rng)
    outer = _draw(np.flatnonzero(~close), count - len(inner), rng)
    return voxel_places(grid, np.concatenate([inner, outer]))


def _draw(candidates: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    if len(candidates) <= count:
        return candidates
    return np.sort(rng.choice(candidates, count, replace=False))
