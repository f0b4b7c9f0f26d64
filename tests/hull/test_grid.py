"""The grid around a hull: a block of voxels in a larger grid that stands aslant."""

import numpy as np
from scipy.spatial.transform import Rotation

from threedfs.geometry.grid import voxel_centres
from threedfs.hull.grid import enclose_hull
from threedfs.types import VoxelGrid

AXES = Rotation.from_euler("xyz", [20, -30, 50], degrees=True).as_matrix()
GRID = VoxelGrid(np.array([0.3, -0.2, 0.5]), 0.1, (20, 16, 12), AXES)


def test_the_box_reaches_a_margin_around_the_hull_but_not_out_of_the_grid():
    """Exact: 2 voxels around the outermost centres, and the grid's own faces where it ends before."""
    field = np.ones(GRID.shape, np.float32)
    field[5:9, 1:4, 6:12] = -1
    box = enclose_hull(field, GRID, 2.0)
    first = GRID.axes @ GRID.origin
    np.testing.assert_allclose((box.low - first) / GRID.spacing, [3, -0.5, 4])
    np.testing.assert_allclose((box.high - first) / GRID.spacing, [10, 5, 11.5])
    assert box.contains(voxel_centres(GRID)[field < 0]).all()


def test_of_an_empty_hull_it_is_the_whole_grid():
    box = enclose_hull(np.ones(GRID.shape, np.float32), GRID, 2.0)
    np.testing.assert_allclose((box.high - box.low) / GRID.spacing, GRID.shape)
