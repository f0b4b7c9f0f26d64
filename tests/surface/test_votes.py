"""Exact: how far votes of depth reach."""

import numpy as np
import pytest
from slab import CAMERA, GRID, VIEWS, make_slab, see_depth

from threedfs.fusion.fuse import VoteRule, start_fusion
from threedfs.object.extract import extract_surface
from threedfs.surface.votes import ReachRule, start_votes
from threedfs.types import VoxelGrid

VOTE = VoteRule(softmax_hardness=10.0, distrust=0.5, hidden=0.5, depth_discontinuity=0.1, facing=0.3, trust_blur=0.0)


@pytest.mark.parametrize(
    ("sureness", "thickness", "expected"),
    [
        (0.0, 9.0, 1.0),  # ten voxels of 0.1
        (1.0, 9.0, 0.5),  # half as many on a sure object
        (0.5, 9.0, 0.75),
        (0.0, 2.0, 0.5),  # a quarter of a thin object
        (1.0, 2.0, 0.25),
        (1.0, 0.2, 0.2),  # never less than two voxels
    ],
)
def test_votes_of_sure_depth_reach_less_far(sureness, thickness, expected):
    reach = ReachRule(clip_distance=10.0, hidden_distance=2.0, thickness_share=0.25, sure_clip_share=0.5)
    grid = VoxelGrid(np.zeros(3), 0.05, (4, 4, 4))
    votes, clip_distance = start_votes(grid, sureness, thickness, 0.1, reach, VOTE)
    assert clip_distance == pytest.approx(expected)
    assert votes.grid is grid


def test_clip_distance_stays_two_voxels_where_a_share_of_it_is_less():
    reach = ReachRule(clip_distance=2.0, hidden_distance=2.0, thickness_share=0.0, sure_clip_share=0.5)
    _, clip_distance = start_votes(VoxelGrid(np.zeros(3), 0.05, (4, 4, 4)), 1.0, 9.0, 0.1, reach, VOTE)
    assert clip_distance == pytest.approx(0.2)


def fuse(votes):
    """Return the field of a slab that all views have seen."""
    solid = extract_surface(make_slab(), GRID)
    trust = np.ones(CAMERA.shape, np.float32)
    votes.add_all((view, see_depth(solid, view), trust) for view in VIEWS.values())
    return votes.result()[0]


def test_what_is_hidden_is_measured_by_the_same_share():
    """Exact: of a half-sure object the rule's distances count three quarters."""
    reach = ReachRule(clip_distance=8.0, hidden_distance=4.0, thickness_share=0.0, sure_clip_share=0.5)
    found = fuse(start_votes(GRID, 0.5, 9.0, GRID.spacing, reach, VOTE)[0])
    voxel = GRID.spacing
    np.testing.assert_array_equal(found, fuse(start_fusion(GRID, 6 * voxel, VOTE, hidden_distance=3 * voxel)))
    assert (found != fuse(start_fusion(GRID, 6 * voxel, VOTE, hidden_distance=4 * voxel))).any()
