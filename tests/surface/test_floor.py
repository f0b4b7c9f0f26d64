"""Floor that masks take for the object, as depth tells."""

from dataclasses import replace

import numpy as np
import pytest
from test_mirrored import MIRRORS, SUPPORT, see_mirror
from test_trust import RULE

from threedfs.surface.floor import find_floor, may_tell_floor
from threedfs.surface.keyframe_depth import KeyframeDepth


def look(agree=0, length=50.0, within=None, level=0.005):
    """Return a keyframe whose mask holds floor on the slab's side, as its depth says, and where that is."""
    depth, mask, side = see_mirror(MIRRORS, level)
    counts, rates = np.full(depth.shape, agree, np.uint8), np.ones(depth.shape, np.float32)
    if within is not None:
        depth = np.where(side & ~within, np.nan, depth)
    return KeyframeDepth(MIRRORS, mask, length, depth, rates, counts, 0 * counts, rates), side


def find(found):
    return find_floor(found, found.mask, SUPPORT, RULE)


@pytest.mark.parametrize("agree", [0, 2])
def test_depth_in_the_plane_that_few_views_agree_on_is_floor(agree):
    """Exact: nothing else is, and of the side only what is narrower than the least place is not."""
    found, side = look(agree)
    floor = find(found)
    assert not (floor & ~side).any()
    assert (floor & side).sum() > 0.9 * side.sum()


def test_what_views_agree_on_is_not():
    found, _ = look(3)
    assert not find(found).any()


@pytest.mark.parametrize(("level", "told"), [(-0.01, True), (0.0019, True), (0.0021, False)])
def test_in_the_plane_itself_it_is_floor_however_many_agree(level, told):
    """Exact: up to 0.005 of the slab's height, which is 0.4."""
    _, side = look()
    rim = side & (np.cumsum(side[::-1], axis=0)[::-1] <= 6)  # its lowest pixels
    found, _ = look(9, within=rim, level=level)
    floor = find(found)
    assert not (floor & ~rim).any()
    assert floor.any() == told


def test_a_side_that_lies_there_for_all_views_is_lost_not_floor():
    """Exact: it is more than a tenth of the mask."""
    found, side = look(9, level=0.0)
    assert side.sum() > 0.1 * found.mask.sum()
    assert not find(found).any()


def test_a_foot_that_many_see_is_not():
    """Exact: what views agree on is floor where it is four hundredths of the object's length wide."""
    _, side = look()
    foot = side & (np.indices(side.shape)[1] % 12 < 6)
    found, _ = look(9, within=foot, level=0.0)
    assert find(found).any()
    assert not find(replace(found, length=150.0)).any()


def test_only_an_object_whose_depth_is_sure_tells():
    assert may_tell_floor(1.0) and may_tell_floor(0.6) and not may_tell_floor(0.59)


def test_a_narrow_rim_is_not():
    """Exact: three pixels wide it is none where seven are asked for, and one where three are."""
    _, side = look()
    rim = side & (np.indices(side.shape)[1] % 12 < 3)
    narrow, _ = look(length=300.0, within=rim)
    assert not find(narrow).any()
    assert find(replace(narrow, length=50.0)).any()


def test_a_mask_that_would_be_floor_for_the_most_part_stays():
    """Exact: a mask of which the side is more than a half."""
    found, side = look()
    assert not find_floor(found, side, SUPPORT, RULE).any()
    assert find_floor(found, found.mask, SUPPORT, RULE).any()


def test_no_depth_tells_nothing():
    found, _ = look()
    assert not find(replace(found, depth=np.full_like(found.depth, np.nan))).any()


def test_what_the_object_surrounds_is_a_mirror_image():
    """Exact: the same place, part of a mask that goes on all around it."""
    within = np.zeros(MIRRORS.camera.shape, bool)
    _, side = look()
    rows, columns = np.nonzero(side)
    middle = int(np.median(rows)), int(np.median(columns))
    within[middle[0] - 6 : middle[0] + 7, middle[1] - 6 : middle[1] + 7] = True
    found, _ = look(within=within)
    assert within[side].sum() > 100
    assert not find(found).any()
    beside = np.indices(within.shape)[1] < middle[1]
    assert find_floor(found, found.mask & ~beside, SUPPORT, RULE).any()
