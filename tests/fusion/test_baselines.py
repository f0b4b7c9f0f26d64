"""The fusions that the soft maximum is compared with: closed forms and properties."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.fusion.fuse import fuse_views
from threedfs.fusion.hard_maximum import HardMaximum
from threedfs.fusion.softmax import SoftMaximum
from threedfs.fusion.weighted_average import WeightedAverage
from threedfs.geometry.grid import cover_box, voxel_centres
from threedfs.types import Box, Camera, View, VoxelGrid

FACING = View("a", Camera(81, 81, 100.0, 100.0, 40.0, 40.0), np.eye(4))
SLAB = VoxelGrid(np.array([-0.2, -0.1, 0.7]), 0.02, (21, 11, 31))
BOX = cover_box(Box(np.eye(3), np.array([-0.35, -0.35, 0.02]), np.array([0.35, 0.35, 0.6])), 50)


def ray_distance(depth, clip):
    centres = voxel_centres(SLAB)
    return (depth - centres[..., 2]) * np.linalg.norm(centres / centres[..., 2:], axis=-1) / clip


def fuse(fused, depths):
    return fuse_views(((FACING, np.full((81, 81), depth)) for depth in depths), fused)


def test_hard_maximum_is_the_largest_of_the_views():
    """Exact: two planes seen head on (Eq. 13)."""
    sdf, seen = fuse(HardMaximum(SLAB, 0.05, discontinuity=0.02), [1.0, 1.04])
    np.testing.assert_allclose(sdf, np.clip(ray_distance(1.04, 0.05), -1, 1), atol=1e-5)
    assert (seen == 2).all()


def test_weighted_average_is_the_mean_of_views_that_say_something():
    """Exact: two planes seen alike; behind the nearer one by more than the truncation only the farther one speaks."""
    near, far = ray_distance(1.0, 0.05), ray_distance(1.04, 0.05)
    expected = np.where(near >= -1, (np.minimum(near, 1) + np.minimum(far, 1)) / 2, np.where(far >= -1, far, -1))
    sdf, seen = fuse(WeightedAverage(SLAB, 0.05, discontinuity=0.02), [1.0, 1.04])
    border = np.minimum(np.abs(near + 1), np.abs(far + 1)) < 1e-4
    np.testing.assert_allclose(sdf[~border], np.maximum(expected, -1)[~border], atol=1e-4)
    assert (seen == 2).all()


def test_a_view_of_a_surface_that_turns_away_counts_less():
    """Property: of two views that disagree the one that faces its surface has more weight."""
    facing, turning = np.full((81, 81), 1.0), np.linspace(0.5, 1.7, 81)[None, :].repeat(81, 0)

    def average(*depths):
        fused = WeightedAverage(SLAB, 0.3, discontinuity=10.0)
        for depth in depths:
            fused.add(FACING, depth)
        return fused.result()[0]

    one, other, both = average(facing), average(turning), average(facing, turning)
    heard = (np.abs(one) < 0.9) & (np.abs(other) < 0.9) & (np.abs(one - other) > 0.1)
    share = (both - one)[heard] / (other - one)[heard]
    assert heard.sum() > 100
    assert 0 < np.median(share) < 0.42


@pytest.mark.parametrize("kind", [HardMaximum, WeightedAverage])
def test_sphere_is_found_within_a_voxel(table, kind):
    """Convergence: exact depth maps of a sphere on a table put the zero level on its upper half."""
    fused = kind(BOX, 4 * BOX.spacing, discontinuity=0.02)
    sdf, _ = fuse_views(((view, table.depth(view)) for view in table.views), fused)
    offset = voxel_centres(BOX) - table.centre
    distance = np.linalg.norm(offset, axis=-1) - table.radius
    upper = offset[..., 2] > 0.05
    assert (sdf[upper & (distance > 1.5 * BOX.spacing) & (distance < 4 * BOX.spacing)] > 0).mean() > 0.99
    assert (sdf[upper & (distance < -1.5 * BOX.spacing)] < 0).all()


def test_hard_maximum_bounds_the_soft_one(table):
    hard, soft = (
        HardMaximum(BOX, 0.05, discontinuity=0.02),
        SoftMaximum(BOX, 0.05, 10.0, distrust=0, discontinuity=0.02),
    )
    for view in table.views[:4]:
        hard.add(view, table.depth(view))
        soft.add(view, table.depth(view))
    assert (soft.result()[0] <= hard.result()[0] + 1e-6).all()


@pytest.mark.parametrize("kind", [HardMaximum, WeightedAverage])
def test_cores_do_not_change_the_field(table, kind):
    one, two = (kind(BOX, 0.05, discontinuity=0.02, threads=threads) for threads in (1, 2))
    for fused in (one, two):
        fused.add(table.views[0], table.depth(table.views[0]))
    np.testing.assert_array_equal(one.result()[0], two.result()[0])


@pytest.mark.parametrize("kind", [HardMaximum, WeightedAverage])
def test_map_of_another_size_is_refused(kind):
    with pytest.raises(UserError, match="depth of view a"):
        kind(SLAB, 0.05, discontinuity=0.02).add(FACING, np.ones((3, 4)))
