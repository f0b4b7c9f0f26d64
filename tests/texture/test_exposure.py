"""Exact and property: gains that were put on samples are found back."""

import numpy as np
import pytest

from threedfs.texture.exposure import apply_gains, expose, find_gains
from threedfs.texture.vertices import ABSENT

GAINS = np.array([[1.0, 1.0, 1.0], [0.8, 0.9, 1.0], [1.0, 1.0, 1.0], [1.2, 1.1, 0.9], [1.0, 1.0, 1.1]])


@pytest.fixture
def samples():
    """Samples of 400 vertices by five views of different exposure; each view misses 100 vertices of its own."""
    generator = np.random.default_rng(1)
    true = generator.integers(40, 200, (400, 3))
    found = np.rint(true * GAINS[:, None]).astype(np.uint16)
    for rank, view in enumerate(found):
        view[80 * rank : 80 * rank + 100] = ABSENT
    return found


def test_gains_are_found_back(samples):
    """Exact but for the rounding of levels: what was put on is taken off, and the mean is 1."""
    gains = find_gains(samples)
    np.testing.assert_allclose(gains.mean(axis=0), 1, atol=1e-12)
    left = gains * GAINS
    np.testing.assert_allclose(left / left.mean(axis=0), 1, atol=0.005)


def test_views_agree_after_their_gains(samples):
    levelled = apply_gains(samples, find_gains(samples)).astype(float)
    levelled[samples == ABSENT] = np.nan
    assert np.nanmax(np.nanmax(levelled, axis=0) - np.nanmin(levelled, axis=0)) <= 3


def test_equal_views_have_gains_of_one():
    """Exact."""
    same = np.tile(np.random.default_rng(2).integers(0, 256, (50, 3)), (4, 1, 1)).astype(np.uint16)
    np.testing.assert_array_equal(find_gains(same), 1)
    np.testing.assert_array_equal(apply_gains(same, np.ones((4, 3))), same)


def test_a_view_of_nothing_and_a_black_one_keep_about_what_they_have(samples):
    """Property: no gain is 0, infinite or no number."""
    samples[0], samples[2] = ABSENT, 0
    gains = find_gains(samples)
    assert np.isfinite(gains).all() and (gains > 0.5).all() and (gains < 2).all()


def test_absent_stays_absent_and_nothing_becomes_absent():
    """Exact: white under a gain is at most white."""
    samples = np.array([[[ABSENT] * 3, [255, 0, 100]]], np.uint16)
    np.testing.assert_array_equal(apply_gains(samples, np.array([[3.0, 3.0, 0.5]])), [[[ABSENT] * 3, [255, 0, 50]]])


def test_a_gain_on_an_image_is_that_on_samples():
    """Exact."""
    image = np.random.default_rng(3).integers(0, 256, (5, 7, 3), np.uint8)
    gain = np.array([0.7, 1.0, 1.6])
    expected = apply_gains(image.reshape(1, -1, 3).astype(np.uint16), gain[None])
    np.testing.assert_array_equal(expose(image, gain).reshape(1, -1, 3), expected)
