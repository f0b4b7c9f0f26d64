"""Oracle and exact: an image compared with the support surface as it would look in it."""

import numpy as np
import pytest

from threedfs.segment.table import match_table


@pytest.fixture
def picture():
    """Colour, spread, what is known and what is beneath of a random picture."""
    rng = np.random.default_rng(3)
    color = rng.uniform(0, 100, (9, 12, 3)).astype(np.float32)
    return color, rng.uniform(0, 5, (9, 12)).astype(np.float32), rng.random((9, 12)) < 0.7, np.zeros((9, 12), bool)


def test_the_best_match_within_a_pixel_counts(picture):
    color, spread, known, _ = picture
    lab = np.random.default_rng(4).uniform(0, 100, color.shape).astype(np.float32)
    turns = [(down, across) for down in (-1, 0, 1) for across in (-1, 0, 1)]
    apart = [
        np.where(np.roll(known, turn, (0, 1)), ((lab - np.roll(color, turn, (0, 1))) ** 2).sum(-1), np.inf)
        for turn in turns
    ]
    deviation = np.sqrt(3.0**2 + (0.9 * spread) ** 2)
    expected = -0.5 * np.min(apart, axis=0) / deviation**2 - 3 * np.log(deviation) - 1.5 * np.log(2 * np.pi)
    np.testing.assert_allclose(match_table(lab, *picture).density, expected, rtol=1e-6)


def test_a_picture_moved_by_a_pixel_matches_as_well_as_itself(picture):
    color, spread, _, beneath = picture
    all_known = np.ones(spread.shape, bool)
    flat = np.full_like(spread, 1.0)
    still, moved = (
        match_table(lab, color, flat, all_known, beneath).density for lab in (color, np.roll(color, (1, -1), (0, 1)))
    )
    np.testing.assert_array_equal(still, moved)


def test_where_nothing_is_known_nearby_nothing_matches(picture):
    color, spread, known, beneath = picture
    found = match_table(color, color, spread, np.zeros_like(known), beneath)
    assert np.isneginf(found.density).all()
