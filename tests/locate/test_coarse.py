"""Exact: the coarse object is what is solid in its box, over the plane."""

import numpy as np

from threedfs.geometry.grid import voxel_centres
from threedfs.locate.coarse import mark_coarse
from threedfs.types import Box, Plane, Support, VoxelGrid

GRID = VoxelGrid(np.array([-1.03, -1.03, -0.53]), 0.1, (21, 21, 21))
TURN = np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])
SUPPORT = Support(
    Plane(np.array([0.0, 0, 1]), 0.0), Box(TURN, np.array([-0.42, -0.42, -0.12]), np.array([0.42, 0.42, 0.82])), {}
)


def test_solids_in_the_box_above_the_plane_are_marked():
    """A wall through the plane and beyond the box, which is turned."""
    centres = voxel_centres(GRID)
    along, across, z = np.moveaxis(centres @ TURN.T, -1, 0)
    solid = (np.abs(across) < 0.25) & (z < 0.55)
    around, marked = mark_coarse(GRID, np.where(solid, -1, 1).astype(np.float32), SUPPORT)
    assert marked.shape == around.shape and max(around.shape) < 16
    expected = solid & (np.abs(along) < 0.42) & (z > 0.1)
    found = {tuple(point) for point in np.round(voxel_centres(around)[marked], 6)}
    assert found == {tuple(point) for point in np.round(centres[expected], 6)} and len(found) > 100
