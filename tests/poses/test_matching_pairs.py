"""Oracle: matching against a plain search in float64; exact: pairs."""

from __future__ import annotations

import numpy as np
import pytest
from orbit import make_orbit

from threedfs.poses.matching import match_pairs
from threedfs.poses.pairs import exhaustive_pairs, overlapping_pairs, sequential_pairs

SETTINGS = {"max_ratio": 0.8, "max_angle": 0.7, "min_matches": 1}


def descriptors(rng, count):
    """Draw descriptors of length 512."""
    drawn = rng.exponential(1, (count, 128))
    return np.rint(512 * drawn / np.linalg.norm(drawn, axis=1, keepdims=True)).clip(0, 255).astype(np.uint8)


def search_plainly(first, second):
    """Match by the definition, one descriptor at a time."""
    angle = np.arccos(np.minimum(first.astype(float) @ second.T.astype(float) / 512**2, 1))
    found = []
    for i, row in enumerate(angle):
        j = row.argmin()
        rival = min(np.delete(row, j).min(), np.delete(angle[:, j], i).min())
        if angle[:, j].argmin() == i and row[j] <= 0.7 and row[j] < 0.8 * rival:
            found.append((i, j))
    return np.array(found)


def test_matches_are_those_of_a_plain_search():
    rng = np.random.default_rng(1)
    first = descriptors(rng, 120)
    second = np.concatenate([first[20:90] + rng.integers(0, 9, (70, 128)), descriptors(rng, 40)]).clip(0, 255)
    second = second.astype(np.uint8)
    found = match_pairs([first, second], [(0, 1)], threads=1, **SETTINGS)[0, 1]
    expected = search_plainly(first, second)
    assert len(expected) > 50
    np.testing.assert_array_equal(found, expected)


def test_matches_do_not_depend_on_threads():
    frames = [frame.descriptors for frame in make_orbit(6, 0.2).features]
    pairs = exhaustive_pairs(6)
    one, two = (match_pairs(frames, pairs, threads=threads, **SETTINGS) for threads in (1, 3))
    assert list(one) == list(two)
    assert all(one[pair].tobytes() == two[pair].tobytes() for pair in one)


def test_a_descriptor_that_occurs_twice_is_not_matched():
    rng = np.random.default_rng(2)
    first = descriptors(rng, 10)
    second = np.concatenate([first, first[:3]])
    found = match_pairs([first, second], [(0, 1)], threads=1, **SETTINGS)[0, 1]
    np.testing.assert_array_equal(found[:, 0], np.arange(3, 10))


@pytest.mark.parametrize("count", [0, 1])
def test_a_frame_without_features_matches_nothing(count):
    rng = np.random.default_rng(3)
    assert match_pairs([descriptors(rng, 5), descriptors(rng, count)], [(0, 1)], threads=1, **SETTINGS) == {}


def test_sequential_and_exhaustive_pairs():
    assert len(sequential_pairs(20, 4)) == 4 * 20 - 10
    assert exhaustive_pairs(4) == [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]


def test_overlapping_pairs_look_the_same_way_and_are_near():
    orbit = make_orbit(36, 35 / 36)
    pairs = overlapping_pairs(orbit.poses, max_angle=np.radians(25), most=4)
    apart = {min(abs(a - b), 36 - abs(a - b)) for a, b in pairs}
    # Frames are 10 degrees apart: the four nearest are the first and second on either side, round the end.
    assert apart == {1, 2}
    assert (0, 35) in pairs and len(pairs) == 2 * 36
