"""Exact: the coarse object is what is solid in its box, over the plane."""

import numpy as np

from threedfs.geometry.grid import voxel_centres
from threedfs.locate.coarse import mark_coarse
from threedfs.types import Box, Plane, Support, VoxelGrid

GRID = VoxelGrid(np.array([-1.0, -1, -0.5]), 0.1, (21, 21, 21))
SUPPORT = Support(
    Plane(np.array([0.0, 0, 1]), 0.0), Box(np.eye(3), np.array([-0.42, -0.42, -0.12]), np.array([0.42, 0.42, 0.82])), {}
)


def test_solids_in_the_box_above_the_plane_are_marked():
    """Two blocks that go through the plane: one within the box, one beyond it."""
    centres = voxel_centres(GRID)
    x, y, z = np.moveaxis(centres, -1, 0)
    solid = (np.abs(y) < 0.25) & (z < 0.55) & ((np.abs(x) < 0.25) | (np.abs(x - 0.8) < 0.15))
    around, marked = mark_coarse(GRID, np.where(solid, -1, 1).astype(np.float32), SUPPORT)
    assert marked.shape == around.shape and max(around.shape) < 13
    expected = solid & (np.abs(x) < 0.42) & (z > 0.15)
    found = {tuple(point) for point in np.round(voxel_centres(around)[marked], 6)}
    assert found == {tuple(point) for point in np.round(centres[expected], 6)} and len(found) == 5 * 5 * 4
