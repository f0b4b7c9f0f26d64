"""Space that too few views see and find free is filled; hollows that they look into stay."""

from dataclasses import replace

import numpy as np
import pytest
from slab import GRID, confirm, make_slab

from threedfs.surface.sight import fill_unseen
from threedfs.surface.sky import spread_directions

EVERYWHERE, ALLOWED = np.ones(GRID.shape, bool), make_slab()
UP = np.array([0.0, 0, 1])
PIT = np.s_[12:15, 12:15, 4:16]
CAVE = np.s_[8:19, 8:19, 4:8]
BOWL = np.s_[22:34, 22:34, 13:16]


@pytest.fixture(scope="module")
def carved():
    """A slab with a bowl, and with a cave behind a narrow mouth that is not there."""
    true = make_slab()
    true[BOWL] = 1
    wrong = true.copy()
    wrong[PIT], wrong[CAVE] = 1, 1
    return true, wrong


def test_a_cave_that_no_view_looks_into_is_filled_and_a_bowl_stays(carved):
    true, wrong = carved
    filled = fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, confirm(true), 0.3)
    assert (filled[CAVE] < 0).all() and (filled[12:15, 12:15, 4:13] < 0).all()
    np.testing.assert_array_equal(filled[25:31, 25:31, 14:16], 1)


def test_what_views_find_free_stays_free_however_narrow(carved):
    """Property: where depth says that views look into the pit, its mouth stays; with no view asked for all does."""
    _, wrong = carved
    depth = confirm(wrong)
    filled = fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, depth, 0.1)
    assert (filled[13, 13, 14:16] > 0).all() and (filled[8, 8, 4:8] < 0).all()
    assert fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, depth, 0.0) is wrong


def test_the_surer_the_depth_the_fewer_views_must_look(carved):
    true, wrong = carved
    means = [
        fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, confirm(wrong, sureness), 1.0)[PIT].mean()
        for sureness in (0, 0.8, 0.9)
    ]
    assert -1 < means[0] < means[1] < means[2] < 1
    assert fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, confirm(true, 1.0), 1.0) is wrong


def test_nothing_leaves_the_hull_or_the_support_plane(carved):
    true, wrong = carved
    hull, above = ALLOWED.copy(), EVERYWHERE.copy()
    hull[:, :14] = 1
    above[:, :, :6] = False
    filled = fill_unseen(wrong, hull, above, UP, confirm(true), 0.3)
    changed = filled != wrong
    assert changed.any() and not changed[:, :14].any() and not changed[:, :, :6].any()


def test_on_two_threads_as_on_one(carved):
    true, wrong = carved
    depth = confirm(true)
    both = [fill_unseen(wrong, ALLOWED, EVERYWHERE, UP, replace(depth, threads=threads), 0.3) for threads in (1, 2)]
    np.testing.assert_array_equal(*both)


def test_what_is_open_to_the_sky_is_no_pit(carved):
    """Property: a wide step that no view finds free, as all were taken from elsewhere, stays free; a shaft does not."""
    stepped = make_slab()
    stepped[22:-4, 4:-4, 8:16] = 1
    stepped[10:12, 18:20, 4:16] = 1
    blind = confirm(make_slab())  # depth before the step and the shaft
    filled = fill_unseen(stepped, ALLOWED, EVERYWHERE, UP, blind, 1.0)
    assert (filled[24:34, 8:-8, 9:16] > 0).all() and (filled[10:12, 18:20, 5:12] < 0).all()


def test_directions_cover_the_sky_evenly():
    """Exact: unit vectors, upward, whose mean is half way up, as that of a half sphere is."""
    sky = spread_directions(48)
    np.testing.assert_allclose(np.linalg.norm(sky, axis=1), 1)
    assert sky[:, 2].min() > 0
    np.testing.assert_allclose(sky.mean(axis=0), (0, 0, 0.5), atol=0.03)
