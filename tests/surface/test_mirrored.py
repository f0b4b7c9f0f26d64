"""An upright mirror shows the support plane in itself: such depth carves no hole into a bare object."""

import numpy as np
import pytest
from slab import CAMERA, GRID, VIEWS, make_slab, see_depth
from test_adopt import RULE as ADOPT
from test_trust import RULE as TRUST

from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.projection import backproject_map
from threedfs.object.extract import extract_surface
from threedfs.surface.confirmed import confirm_depth
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.surface.mirrored import believe_mirrored, find_mirrored
from threedfs.types import Box, Plane, Support

SUPPORT = Support(
    Plane(np.array([0.0, 0, 1]), 0.0), Box(np.eye(3), np.array([-0.5, -0.5, 0]), np.array([0.5, 0.5, 0.4])), {}
)
SLAB = extract_surface(make_slab(), GRID)


def see_mirror(view):
    """Return a slab's depth, mask, and where its side at x > 0 shows the plane z = 0 in its place."""
    depth = see_depth(SLAB, view)
    mask = np.isfinite(depth)
    points = backproject_map(view, depth)
    side = mask & (points[..., 0] > 0.38) & (points[..., 2] < 0.3)
    rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre  # of camera depth 1
    return np.where(side, -view.centre[2] / rays[..., 2], depth).astype(np.float32), mask, side


@pytest.mark.parametrize("share", [0.0, 0.02])
def test_depth_in_the_plane_is_found_and_no_other(share):
    for view in VIEWS.values():
        depth, mask, side = see_mirror(view)
        found = find_mirrored(view, mask, depth - np.float32(1e-4), SUPPORT, share + 1e-3)
        height = SUPPORT.plane.distance(backproject_map(view, depth))
        assert found[side].all() and (height[found] < 0.4 * (share + 1e-3)).all()


def test_what_lies_outside_of_the_mask_or_has_no_depth_is_none():
    view = next(iter(VIEWS.values()))
    depth, mask, side = see_mirror(view)
    assert not find_mirrored(view, mask & ~side, np.where(side, depth, np.nan), SUPPORT, 0.02)[side].any()
    assert not find_mirrored(view, mask, np.full_like(depth, np.nan), SUPPORT, 0.02).any()


@pytest.mark.parametrize(("sureness", "trust"), [(0.0, 0.0), (0.4, 0.4), (1.0, 1.0)])
def test_it_is_believed_as_far_as_the_depth_of_the_object_is_sure(sureness, trust):
    believed = believe_mirrored(np.array([True, False]), sureness)
    np.testing.assert_allclose(believed, [trust, 1.0], rtol=1e-6)
    assert believed.dtype == np.float32


def fuse(share):
    """Return the field, (nx, ny, nz) float32, of all views of the mirror, who agree on what they see, and the hull."""

    def read(name):
        view = VIEWS[name]
        depth, mask, _ = see_mirror(view)
        agree, rates = np.full(CAMERA.shape, 8, np.uint8), np.ones(CAMERA.shape, np.float32)
        mirrored = find_mirrored(view, mask, depth, SUPPORT, share)
        return KeyframeDepth(view, mask, 50.0, depth, 0 * rates, agree, 0 * agree, rates, mirrored)

    def start(sureness):
        assert sureness == 0
        return SoftMaximum(GRID, 4 * GRID.spacing, 10.0, distrust=40.0, discontinuity=0.1), 4 * GRID.spacing

    bare = TRUST.__class__(**{**vars(TRUST), "sure_from": 2.0, "sure_full": 3.0})
    return confirm_depth(VIEWS, read, start, bare, ADOPT).fused.result_with([(make_slab(), 0.5)])


def test_a_mirror_carves_a_bare_object_only_where_its_image_is_believed():
    """With the hull of the masks, which is the slab, as trusted as half a view."""
    behind = np.s_[33:35, 16:25, 6:9]  # two voxels behind the face at x = 0.4
    assert (fuse(-1.0)[behind] > 0.5).mean() > 0.25
    assert (fuse(0.05)[behind] < -0.5).all()
