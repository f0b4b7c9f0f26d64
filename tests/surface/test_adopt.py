"""Where a keyframe's own photographs do not match, it adopts what others have found there, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest
from slab import GRID, VIEWS, make_slab, see_depth

from threedfs.object.extract import extract_surface
from threedfs.surface.adopt import AdoptRule, adopt_depth, lend_depth
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.types import Mesh

RULE = AdoptRule(lent_from=6.0, adopted_within=0.015, adopted_reach=0.02, adopted_full=0.4, adopted_until=0.6)
LENGTH = 100.0
OWN, *OTHERS = VIEWS.values()
SLAB = extract_surface(make_slab(), GRID)
TRUE = see_depth(SLAB, OWN).astype(np.float32)
MASK = np.isfinite(TRUE)
TOP = np.zeros(MASK.shape, bool)
TOP[45:60, 50:70] = True
"""A patch of the slab's upper face."""
BARE = np.where(TOP, 0.0, 1.0)


def know(view, depth, mask, agree=8, confidence=1.0):
    """Return a keyframe's depth of which `agree` views say the same, with no match of photographs."""
    depth = depth.astype(np.float32)
    counts = np.full(depth.shape, agree, np.uint8)
    rates = np.full(depth.shape, confidence, np.float32)
    return KeyframeDepth(view, mask, LENGTH, depth, 0 * rates, counts, 0 * counts, rates)


def lend(depth_of=lambda view: see_depth(SLAB, view), views=OTHERS, **said):
    for view in views:
        depth = depth_of(view)
        yield lend_depth(know(view, depth, np.isfinite(depth), **said), RULE)


def adopt(own, lent=None, matched=BARE, mask=MASK, rule=RULE):
    return adopt_depth(know(OWN, own, mask), matched, lend() if lent is None else lent, rule)


@pytest.mark.parametrize("shift", [-0.012, 0.004, 0.012])
def test_a_bare_patch_moves_to_where_others_have_found_it(shift):
    """Property: an error up to what may be bridged falls to a twentieth."""
    depth = adopt(TRUE * np.float32(1 + shift))
    inner = np.s_[48:57, 54:66]
    assert np.abs(depth[inner] / TRUE[inner] - 1).max() < abs(shift) / 20 + 2e-4


def test_what_matches_stays_to_the_byte():
    wrong = TRUE * np.float32(1.01)
    depth = adopt(wrong)
    np.testing.assert_array_equal(depth[~TOP], wrong[~TOP])


def test_between_bare_and_matched_it_moves_in_part():
    half = adopt(TRUE * np.float32(1.01), matched=np.where(TOP, 0.5, 1.0))
    np.testing.assert_allclose(half[50:55, 56:64] / TRUE[50:55, 56:64] - 1, 0.005, atol=3e-4)


@pytest.mark.parametrize(
    "lent",
    [
        pytest.param({"agree": 5}, id="few-agree"),
        pytest.param({"confidence": 0.4}, id="contradicted"),
        pytest.param({"depth_of": lambda view: 1.05 * see_depth(SLAB, view)}, id="far-from-own"),
        pytest.param({"views": []}, id="no-others"),
    ],
)
def test_nothing_is_adopted_that_is_not_sound(lent):
    wrong = TRUE * np.float32(1.005)
    depth = adopt(wrong, lent=lend(**lent))
    np.testing.assert_allclose(depth, wrong, rtol=1e-6)


def test_the_back_of_a_thin_thing_is_not_adopted():
    """A view from below sees the lower face of a leaf, a hundredth of its depth behind the upper one."""
    leaf = Mesh(SLAB.vertices * (1, 1, 0.02) + (0, 0, 0.39), SLAB.faces)
    own = see_depth(leaf, OWN).astype(np.float32)
    turned = np.diag([1.0, -1.0, -1.0, 1.0])  # half around an axis through the leaf
    turned[2, 3] = 0.8
    below = [replace(view, cam_from_world=view.cam_from_world @ turned) for view in OTHERS]
    lent = list(lend(lambda view: see_depth(leaf, view), views=below))
    assert any(item.lends.sum() > 500 for item in lent)
    depth = adopt(own, lent=lent, matched=np.zeros(own.shape), mask=np.isfinite(own))
    np.testing.assert_array_equal(depth, own)


def test_outside_of_the_object_and_when_turned_off_nothing_is_adopted():
    wrong = TRUE * np.float32(1.01)
    off = replace(RULE, adopted_full=0.0, adopted_until=0.0)
    for depth in (adopt(wrong, mask=MASK & ~TOP), adopt(wrong, rule=off)):
        np.testing.assert_array_equal(depth, wrong)


def test_missing_depth_stays_missing():
    holed = TRUE.copy()
    holed[50:53, 55:60] = np.nan
    depth = adopt(holed)
    np.testing.assert_array_equal(np.isnan(depth), np.isnan(holed))
