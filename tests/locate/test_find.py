"""The object on its own grid: the ball on the table, its foot, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.geometry.rigid import look_at
from threedfs.locate.find import find_object
from threedfs.types import Box, Camera, Plane, Support, View

UP = np.array([0.0, 0.0, 1.0])
SUPPORT = Support(Plane(UP, 0.0), Box(np.eye(3), np.array([-0.5, -0.5, -0.1]), np.array([0.5, 0.5, 0.6])), {})
GRID = cover_box(SUPPORT.box, 50)
CENTRE, RADIUS = np.array([0.05, 0.0, 0.18]), 0.2
VIEWS = [
    View("", Camera(160, 120, 150.0, 150.0, 79.5, 59.5), look_at(np.array([np.cos(a), np.sin(a), 0.7]), CENTRE, UP))
    for a in 2 * np.pi * np.arange(8) / 8
]
LEAST = 1.5 * GRID.spacing
PLACES = voxel_centres(GRID)
BALL = np.linalg.norm(PLACES - CENTRE, axis=-1) - RADIUS
TOY = np.linalg.norm(PLACES - [-0.4, -0.4, 0.1], axis=-1) - 0.07
SDF = np.clip(np.minimum(np.minimum(BALL, TOY), PLACES[..., 2]) / 0.05, -1, 1).astype(np.float32)
SEEN = np.ones(GRID.shape, np.uint8)
CLOUDS = [PLACES[np.abs(BALL) < 0.02], PLACES[np.abs(TOY) < 0.02]]


def find(sdf=SDF, seen=SEEN, clouds=CLOUDS, support=SUPPORT):
    return find_object(GRID, sdf, seen, support, VIEWS, clouds, least_height=LEAST, reach=0.2)


def test_object_is_the_ball_down_to_the_table():
    """Exact above the least height; below it what the ball is over, and nothing under the table."""
    found = find()
    high = found.height > LEAST
    np.testing.assert_array_equal(found.voxels & high, (BALL < 0) & high)
    foot = found.voxels & ~high
    assert foot.any() and (found.height[found.voxels] > 0).all()
    assert (np.linalg.norm((PLACES - CENTRE)[foot][:, :2], axis=-1) < RADIUS).all()
    assert (found.least_height, found.rivals) == (LEAST, 1) and found.supported > 100


def test_solids_that_no_view_sees_are_not_the_object():
    """Exact: the half of the ball that is not seen is left out."""
    seen = SEEN.copy()
    seen[PLACES[..., 0] > CENTRE[0]] = 0
    voxels = find(seen=seen).voxels
    assert voxels.any() and not voxels[seen == 0].any()


def test_object_under_a_turned_plane_stands_on_it():
    """Property: heights are of the plane given, so a plane higher up takes the foot away and no more."""
    higher = replace(SUPPORT, plane=Plane(UP, -0.1))
    before, after = find(), find(support=higher)
    top = PLACES[..., 2] > 0.1 + LEAST + GRID.spacing
    np.testing.assert_array_equal(before.voxels & top, after.voxels & top)
    assert not after.voxels[PLACES[..., 2] < 0.1].any()


@pytest.mark.parametrize("lacks", ["solid", "points"])
def test_nothing_to_be_found_is_refused(lacks):
    """Rejection: no solid above the plane, or none with points."""
    with pytest.raises(UserError, match=r"solid above the support plane .* locate_object\.clearance"):
        find(sdf=np.ones_like(SDF)) if lacks == "solid" else find(clouds=[])
