"""A thin part that some masks lack stays where depth has its surface; a thing beside the object does not come in."""

import numpy as np
import pytest
from slab import CAMERA, GRID, VIEWS, confirm

from threedfs.hull.distance import measure_hull
from threedfs.locate.height import height_above
from threedfs.object.extract import extract_surface
from threedfs.object.silhouettes import draw_silhouette
from threedfs.surface.held import release_bound
from threedfs.types import Plane

HEIGHT = height_above(Plane(np.array([0.0, 0, 1]), 0.0), GRID)
HORN = np.s_[18:22, 18:22, 6:23]
TIP = np.s_[19:21, 19:21, 17:21]
EVERYWHERE = np.ones(GRID.shape, bool)
WHOLE = {name: np.ones(CAMERA.shape, bool) for name in VIEWS}


def make_plinth(horn=True):
    """Return the field of a plinth 6 voxels high, with a horn in its middle or without."""
    field = np.ones(GRID.shape, np.float32)
    field[14:-14, 14:-14, :6] = -1
    if horn:
        field[HORN] = -1
    return field


def see(trust=1.0):
    """Return the depth that all views have of plinth and horn."""
    depth = confirm(make_plinth(), trust=trust)
    depth.fused.add_all((VIEWS[name], depth.read(name), depth.trust[name]) for name in VIEWS)
    return depth


def draw(field):
    return {name: draw_silhouette(extract_surface(field, GRID), view) for name, view in VIEWS.items()}


def bound_by(masks):
    """Return the hull that no more than one of the ten masks may deny."""
    return measure_hull(masks, VIEWS, WHOLE, GRID, EVERYWHERE, ramp=4.0, tolerances=(0.15,))[0]


def release(bound, depth, masks, held_share=0.4, held_height=3.0, height=HEIGHT):
    return release_bound(bound, height, depth, masks, VIEWS, held_share=held_share, held_height=held_height)


@pytest.fixture(scope="module")
def horned():
    """Depth of all, masks of which three lack the horn, and their bound."""
    masks, without = draw(make_plinth()), draw(make_plinth(horn=False))
    masks |= {name: without[name] for name in list(VIEWS)[::4]}
    return see(), masks, bound_by(masks)


def test_masks_that_lack_a_horn_do_not_cut_it_off(horned):
    """Exact: where the bound was outside it is what depth says now, and nothing else has changed."""
    depth, masks, bound = horned
    released = release(bound, depth, masks)
    assert (bound[TIP] > 0).all() and (released[TIP] < 0).all()
    changed = released != bound
    np.testing.assert_array_equal(released[changed], depth.fused.result()[0][changed])
    assert (released[changed] < 0).all() and (bound[changed] > 0).all()


@pytest.mark.parametrize(
    "given",
    [
        {"held_share": 0.0},
        {"held_share": 1.0},  # from a side and from above, no view sees all of it
        {"held_height": 30.0},  # higher than the horn
    ],
)
def test_each_condition_keeps_the_bound(horned, given):
    depth, masks, bound = horned
    np.testing.assert_array_equal(release(bound, depth, masks, **given)[TIP], bound[TIP])


def test_depth_that_is_not_trusted_holds_nothing(horned):
    _, masks, bound = horned
    np.testing.assert_array_equal(release(bound, see(trust=0.4), masks), bound)


def test_a_thing_beside_that_masks_leave_out_stays_out():
    """Property: depth of all views has the horn, but no mask shows it."""
    masks = draw(make_plinth(horn=False))
    bound = bound_by(masks)
    np.testing.assert_array_equal(release(bound, see(), masks)[TIP], bound[TIP])
