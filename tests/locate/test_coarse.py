"""Exact: the coarse object is what is solid in its box, over the plane."""

import numpy as np

from threedfs.geometry.grid import voxel_centres
from threedfs.locate.coarse import fill_notches, mark_coarse
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


def test_the_notch_between_two_legs_is_filled_and_the_room_beside_them_is_not():
    """Exact: a lid that stands out to one side over two legs; what is under it between them is a notch."""
    along, across, z = np.moveaxis(voxel_centres(GRID) @ TURN.T, -1, 0)
    lid = (np.abs(along) < 0.41) & (np.abs(across) < 0.21) & (z > 0.35) & (z < 0.5)
    legs = (
        (along > -0.11) & (along < 0.31) & (np.abs(along - 0.1) > 0.1) & (np.abs(across) < 0.21) & (z > 0) & (z < 0.5)
    )
    standing, filled = fill_notches(GRID, lid | legs, SUPPORT)
    np.testing.assert_allclose(standing.axes, TURN)
    along, across, z = np.moveaxis(voxel_centres(standing) @ TURN.T, -1, 0)
    low, wide = (z > 0.11) & (z < 0.3), np.abs(across) < 0.12
    assert filled[low & wide & (along > -0.03) & (along < 0.25)].all()
    assert not filled[low & (along < -0.2)].any() and filled[(np.abs(z - 0.42) < 0.03) & wide & (along < -0.2)].any()
    assert not filled[(z < 0.1) | (z > 0.6) | (np.abs(across) > 0.3)].any()


def test_nothing_solid_fills_nothing():
    _, filled = fill_notches(GRID, np.zeros(GRID.shape, bool), SUPPORT)
    assert not filled.any()
