"""An upright mirror shows the support plane in itself: such depth carves no hole into a bare object."""

from dataclasses import replace

import numpy as np
import pytest
from slab import CAMERA, GRID, VIEWS, make_slab, see_depth
from test_adopt import RULE as ADOPT
from test_trust import RULE as TRUST

from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.projection import backproject_map
from threedfs.hull.inside import HullInside
from threedfs.locate.mirrored import believe_mirrored, find_mirrored
from threedfs.object.extract import extract_surface
from threedfs.surface.confirmed import confirm_depth
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.types import Box, Plane, Support

TALL = 0.4
SUPPORT = Support(  # a box with a margin of 0.1
    Plane(np.array([0.0, 0, 1]), 0.0),
    Box(np.eye(3), np.array([-0.5, -0.5, -0.1]), np.array([0.5, 0.5, TALL + 0.1])),
    {},
)
SLAB = extract_surface(make_slab(), GRID)
MIRRORS = next(iter(VIEWS.values()))
"""Looks at the side at x > 0."""


def see_mirror(view, level=0.0):
    """Return a slab's depth, mask, and where its side at x > 0 shows a plane at a level in its place."""
    depth = see_depth(SLAB, view)
    mask = np.isfinite(depth)
    points = backproject_map(view, depth)
    side = mask & (points[..., 0] > 0.38) & (points[..., 2] < 0.3) & (points[..., 2] > 0.1 * TALL)
    rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre  # of camera depth 1
    return np.where(side, (level - view.centre[2]) / rays[..., 2], depth).astype(np.float32), mask, side


def find(share, level=0.0):
    """Return where the view at the mirror shows what counts as the plane's image."""
    depth, mask, _ = see_mirror(MIRRORS, level)
    return find_mirrored(MIRRORS, mask, depth, SUPPORT, share)


@pytest.mark.parametrize(("level", "share"), [(-0.3, 0.0), (-0.001, 0.0), (0.019, 0.05), (0.03, 0.08)])
def test_depth_in_the_plane_or_under_it_is_found(level, share):
    _, mask, side = see_mirror(MIRRORS)
    found = find(share, level)
    assert side.any() and found[side].all()
    assert not (found & ~mask).any()


@pytest.mark.parametrize(("level", "share"), [(0.001, 0.0), (0.021, 0.05), (0.034, 0.08)])
def test_depth_above_it_is_not(level, share):
    """Exact: shares are of the object's height, whatever the margin of its box."""
    _, _, side = see_mirror(MIRRORS)
    assert not find(share, level)[side].any()


def test_a_plane_that_is_neither_level_nor_at_the_origin_is_the_same():
    """Property: everything turned and moved alike."""
    turn = np.array([[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]])
    shift = np.array([0.3, -0.2, 0.9])
    away = np.eye(4)
    away[:3, :3], away[:3, 3] = turn, shift
    moved = replace(MIRRORS, cam_from_world=MIRRORS.cam_from_world @ np.linalg.inv(away))
    axes = SUPPORT.box.axes @ turn.T
    box = Box(axes, SUPPORT.box.low + axes @ shift, SUPPORT.box.high + axes @ shift)
    support = Support(Plane(axes[2], -axes[2] @ shift), box, {})
    depth, mask, _ = see_mirror(MIRRORS, 0.01)
    assert find_mirrored(moved, mask, depth, support, 0.05).any()
    np.testing.assert_array_equal(
        find_mirrored(moved, mask, depth, support, 0.05), find_mirrored(MIRRORS, mask, depth, SUPPORT, 0.05)
    )


def test_no_depth_is_no_mirror_image():
    nothing = np.full(CAMERA.shape, np.nan, np.float32)
    assert not find_mirrored(MIRRORS, np.ones(CAMERA.shape, bool), nothing, SUPPORT, 0.05).any()


@pytest.mark.parametrize(("sureness", "trust"), [(0.0, 0.0), (0.4, 0.4), (1.0, 1.0)])
def test_it_is_believed_as_far_as_the_depth_of_the_object_is_sure(sureness, trust):
    believed = believe_mirrored(np.array([True, False]), sureness)
    np.testing.assert_allclose(believed, [trust, 1.0], rtol=1e-6)
    assert believed.dtype == np.float32


BARE = replace(TRUST, sure_from=2.0, sure_full=3.0)


def confirm(share, agree=8, rule=BARE):
    """Return the depth that all views of the mirror have, and what it is worth; `agree` views say the same of each."""
    counts, rates = np.full(CAMERA.shape, agree, np.uint8), np.ones(CAMERA.shape, np.float32)

    def read(name):
        depth, mask, _ = see_mirror(VIEWS[name], 0.005)
        return KeyframeDepth(VIEWS[name], mask, 50.0, depth, 0 * rates, counts, 0 * counts, rates)

    def start(_):
        return SoftMaximum(GRID, 4 * GRID.spacing, 10.0, distrust=40.0, discontinuity=0.1), 4 * GRID.spacing

    inside = HullInside(GRID, make_slab() < 0)
    return confirm_depth(VIEWS, read, start, SUPPORT, inside, replace(rule, mirrored_height=share), ADOPT)


@pytest.mark.parametrize(("rule", "trust"), [((2.0, 3.0), 0.0), ((0.5, 1.5), 0.5), ((0.0, 0.5), 1.0)])
def test_trust_in_it_falls_once_however_many_agree(rule, trust):
    """Exact: the mean trust is 1, so that the object is sure by what is left of the way to `sure_full`."""
    found = confirm(0.05, 9, replace(TRUST, sure_from=rule[0], sure_full=rule[1]))
    mirrored = find(0.05, 0.005)
    assert found.sureness == pytest.approx(trust)
    np.testing.assert_allclose(found.trust[MIRRORS.name][mirrored], trust, atol=1e-6)


def test_a_round_object_is_told_by_what_few_views_agree_on():
    """Contract: of depth inside the slab that two views agree on, all counts or none."""
    rule = replace(BARE, agree_from=0.0, agree_full=100.0, matched_from=0.0, matched_full=0.0)
    alone, agreed = confirm(0.0, 2, rule), confirm(0.0, 2, replace(rule, hollow_agree=2.0))
    assert alone.roundness == 1.0 and agreed.roundness == 0.0
    _, mask, _ = see_mirror(MIRRORS)
    np.testing.assert_allclose(alone.trust[MIRRORS.name][mask].max(), 0.02, rtol=1e-5)
    np.testing.assert_allclose(agreed.trust[MIRRORS.name][mask].max(), 1.0, rtol=1e-5)


def fuse(share):
    """Return the field, (nx, ny, nz) float32, that all views of the mirror make with the hull of the masks."""
    return confirm(share).fused.result_with([(make_slab(), 0.5)])


def test_a_mirror_carves_a_bare_object_only_where_its_image_is_believed():
    """With the hull of the masks, which is the slab, as trusted as half a view."""
    behind = np.s_[33:35, 16:25, 6:9]  # two voxels behind the face at x = 0.4
    assert (fuse(0.0)[behind] > 0.5).mean() > 0.15
    assert (fuse(0.05)[behind] < -0.5).all()
