"""Floor that masks take for the object, as depth tells."""

from dataclasses import replace

import numpy as np
import pytest
from test_mirrored import MIRRORS, SUPPORT, see_mirror
from test_trust import RULE

from threedfs.surface.floor import find_floor
from threedfs.surface.keyframe_depth import KeyframeDepth


def look(agree=0, length=50.0, within=None):
    """Return a keyframe whose mask holds floor on the slab's side, as its depth says, and where that is."""
    depth, mask, side = see_mirror(MIRRORS, 0.005)
    counts, rates = np.full(depth.shape, agree, np.uint8), np.ones(depth.shape, np.float32)
    if within is not None:
        depth = np.where(side & ~within, np.nan, depth)
    return KeyframeDepth(MIRRORS, mask, length, depth, rates, counts, 0 * counts, rates), side


def test_depth_in_the_plane_that_few_views_agree_on_is_floor():
    """Exact, but for the rounded corners of a square that is as wide as the least place."""
    found, side = look()
    floor = find_floor(found, SUPPORT, 1.0, RULE)
    assert not (floor & ~side).any() or (floor & found.mask & ~side).mean() < 0.002
    assert (floor & side).sum() > 0.9 * side.sum()


@pytest.mark.parametrize(("agree", "sureness"), [(3, 1.0), (0, 0.59), (0, 0.0)])
def test_what_views_agree_on_or_a_bare_object_shows_is_not(agree, sureness):
    found, side = look(agree)
    floor = find_floor(found, SUPPORT, sureness, RULE)
    assert not floor[side].any()


def test_a_narrow_rim_is_not():
    """Exact: three pixels wide it is none where seven are asked for, and one where three are."""
    _, side = look()
    rim = side & (np.indices(side.shape)[1] % 12 < 3)
    narrow, _ = look(length=300.0, within=rim)
    assert not find_floor(narrow, SUPPORT, 1.0, RULE)[side].any()
    assert find_floor(replace(narrow, length=50.0), SUPPORT, 1.0, RULE)[side].any()
