"""Property tests of the choice of the object's component, its box and its foot."""

import numpy as np
import pytest

from threedfs.geometry.grid import voxel_centres
from threedfs.locate.box import enclose_object, measure_thickness
from threedfs.locate.component import choose_component, choose_standing_component, mark_points
from threedfs.locate.height import add_foot, height_above
from threedfs.types import Plane, VoxelGrid

GRID = VoxelGrid(np.zeros(3), 0.1, (40, 40, 30))
TABLE = Plane(np.array([0.0, 0, 1]), -0.45)
FIXATION = np.array([2.0, 2.0, 1.0])


def blocks():
    """The object around the fixation point, a larger blob at the border, a small one near by."""
    interior = np.zeros(GRID.shape, bool)
    interior[16:24, 17:24, 5:14] = True
    interior[:, 33:, :] = True
    interior[28:31, 18:22, 5:7] = True
    return interior


def holding(*boxes):
    holds = np.zeros(GRID.shape, bool)
    for box in boxes:
        holds[box] = True
    return holds


OBJECT_SIDE = np.s_[16:24, 17, 5:14]
WALL = np.s_[:, 33, :]
TOY = np.s_[28:31, 18:22, 7]


def choose(interior, holds, **settings):
    return choose_component(interior, GRID, holds, FIXATION, **{"reach": 0.6, **settings})


def test_largest_component_does_not_win():
    """Property: the blob behind is ten times larger and holds more points, but is not what the views look at."""
    chosen = choose(blocks(), holding(OBJECT_SIDE, WALL, TOY))
    assert chosen.voxels.sum() == 8 * 7 * 9
    assert chosen.rivals == 2


def test_points_decide_between_components_at_the_fixation_point():
    """Property: a speck right at the fixation point without points is not the object."""
    interior = blocks()
    interior[16:24, 17:24, 9:12] = False
    interior[20, 20, 10] = True
    chosen = choose(interior, holding(np.s_[16:24, 17, 5:9]))
    assert chosen.voxels[20, 20, 6]
    assert not chosen.voxels[20, 20, 10]


def test_points_beside_a_component_count_for_it():
    """Exact: a surface point may fall into the voxel just outside."""
    chosen = choose(blocks(), holding(np.s_[15:16, 17:24, 5:14]))
    assert chosen.support == 7 * 9


def test_without_points_there_is_no_object():
    """Exact."""
    assert choose(blocks(), holding()) is None
    assert choose(np.zeros(GRID.shape, bool), holding(WALL)) is None


def test_bridge_joins_pieces_without_filling_between():
    """Property: an object carved in two is one, and the gap stays a gap."""
    interior = blocks()
    interior[16:24, 17:24, 9] = False
    holds = holding(OBJECT_SIDE)
    assert choose(interior, holds).voxels.sum() < 8 * 7 * 8
    assert choose(interior, holds, bridge=1).voxels.sum() == 8 * 7 * 8


def test_points_are_marked_where_they_are():
    """Exact: half a voxel around the centre, and nothing outside the grid."""
    holds = np.zeros(GRID.shape, bool)
    mark_points(GRID, np.array([[0.14, 0.0, 0.0], [0.16, 0.0, 0.0], [-0.06, 0, 0], [9, 9, 9]]), holds)
    assert np.argwhere(holds).tolist() == [[1, 0, 0], [2, 0, 0]]


def test_box_holds_the_object_and_its_foot():
    """Exact: from face to face, down to the plane, and the margin shared by both sides."""
    voxels = np.zeros(GRID.shape, bool)
    voxels[16:24, 17:24, 8:14] = True
    box = enclose_object(voxels, GRID, TABLE, margin=0.5)
    longest = 1.35 - 0.40  # along z, from half a voxel below the plane to the top of voxel 13
    corners = box.corners()
    np.testing.assert_allclose(corners.min(axis=0), np.array([1.55, 1.65, 0.40]) - 0.25 * longest, atol=1e-12)
    np.testing.assert_allclose(corners.max(axis=0), np.array([2.35, 2.35, 1.35]) + 0.25 * longest, atol=1e-12)


@pytest.mark.parametrize(("side", "thickness"), [((8, 9, 5), 0.5), ((20, 1, 20), 0.1), ((3, 3, 3), 0.3)])
def test_thickness_of_a_block_is_its_shortest_side(side, thickness):
    """Exact: to the voxel."""
    voxels = np.zeros(GRID.shape, bool)
    voxels[2 : 2 + side[0], 3 : 3 + side[1], 4 : 4 + side[2]] = True
    assert measure_thickness(voxels, GRID.spacing) == pytest.approx(thickness, abs=0.1 + 1e-9)


def test_height_is_the_distance_from_the_plane():
    """Oracle: the plane's own distance, in double precision."""
    plane = Plane(np.array([0.6, 0, 0.8]), -1.0)
    np.testing.assert_allclose(height_above(plane, GRID), plane.distance(voxel_centres(GRID)), atol=1e-6)


def test_foot_reaches_the_plane_straight_below():
    """Exact: under the object and nowhere else, in the layers that the clearance left out."""
    voxels = np.zeros(GRID.shape, bool)
    voxels[16:24, 17:24, 8:14] = True
    owned = add_foot(voxels, height_above(TABLE, GRID), GRID, TABLE, clearance=0.3)
    expected = np.zeros(GRID.shape, bool)
    expected[16:24, 17:24, 4:14] = True
    assert (owned == expected).all()


def test_an_uneven_floor_does_not_join_the_object_with_the_wall():
    """Exact: a bump of the floor two voxels high bridges object and wall; twice the clearance parts them."""
    grid = VoxelGrid(np.zeros(3), 1.0, (30, 30, 30))
    interior = np.zeros(grid.shape, bool)
    interior[12:18, 12:18, :15] = True
    interior[28:, :, :] = True
    interior[:, 14:16, :3] = True
    height = np.broadcast_to(np.arange(30, dtype=np.float32), grid.shape)
    holds = np.zeros(grid.shape, bool)
    holds[12:18, 12, 2:15] = True
    settings = dict(clearance=1.5, reach=20.0)
    fixation = np.array([15.0, 15.0, 8.0])
    chosen = choose_standing_component(interior, height, grid, holds, fixation, doublings=2, **settings)
    assert chosen.voxels.sum() == 6 * 6 * 11  # heights 4 to 14
    joined = choose_standing_component(interior, height, grid, holds, fixation, doublings=0, **settings)
    assert joined.voxels[29].any()
