"""Exact and property: the light of one image beside that of the support surface's picture."""

import numpy as np
import pytest

from threedfs.segment.light import relight_table


@pytest.fixture
def color():
    """A picture in Lab."""
    return np.random.default_rng(5).uniform(20, 80, (60, 83, 3)).astype(np.float32)


def test_one_exposure_is_found_wherever_the_surface_shows(color):
    lab = color + np.float32([7, -2, 3])
    bare = np.zeros(color.shape[:2], bool)
    bare[:, :20] = True
    np.testing.assert_allclose(relight_table(lab, color, bare, 9.0), lab, atol=1e-4)


def test_gloss_is_followed_beneath_what_hides_it(color):
    gloss = 15 * np.exp(-((np.arange(83) - 40) ** 2) / (2 * 25.0**2))[None, :, None]
    lab = (color + gloss).astype(np.float32)
    bare = np.ones(color.shape[:2], bool)
    bare[20:40, 30:50] = False
    hidden = lab.copy()
    hidden[~bare] = 0
    found = relight_table(hidden, color, bare, 8.0)
    before, after = (np.abs(picture - lab)[~bare].max() for picture in (color, found))
    assert before > 14
    assert after < 2.5


def test_a_thing_that_was_moved_is_no_light(color):
    lab = color.copy()
    lab[25:31, 40:46] = [100, 60, -60]
    found = relight_table(lab, color, np.ones(color.shape[:2], bool), 10.0)
    assert np.abs(found - color).max() < 2


def test_the_picture_stays_as_it_is_without_reach_or_without_bare_surface(color):
    lab = color + 5
    assert relight_table(lab, color, np.ones(color.shape[:2], bool), 0.0) is color
    assert relight_table(lab, color, np.zeros(color.shape[:2], bool), 10.0) is color
