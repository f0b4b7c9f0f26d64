"""LSD-SLAM's criterion and the sectors it makes."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.keyframes.sectors import cluster_photos, divide_finely_enough, score_frames, split_sequence


def test_score_follows_the_formula(make_ring):
    """Exact: all points stay in view, so only the distance over the depth counts."""
    ring = make_ring(count=12)
    score = score_frames(ring.visibility, 16.0, 9.0)
    distance = np.linalg.norm(ring.visibility.centres[3] - ring.visibility.centres[0])
    mean_inverse_depth = (1 / ring.visibility.depth[0]).mean()
    np.testing.assert_allclose(score[0, 3], 16 * (distance * mean_inverse_depth) ** 2, rtol=1e-12)
    np.testing.assert_array_equal(np.diag(score), 0)


def test_lost_points_raise_the_score(make_ring):
    """Exact: a frame in which half of the points are out of view adds 9 * (1 - 1/2)^2."""
    ring = make_ring(count=12)
    depth = ring.visibility.depth.copy()
    depth[1, :100] = np.nan
    visibility = type(ring.visibility)(ring.visibility.centres, ring.visibility.xyz, depth, ring.visibility.seen)
    before, after = score_frames(ring.visibility, 16.0, 9.0), score_frames(visibility, 16.0, 9.0)
    np.testing.assert_allclose(after[0, 1] - before[0, 1], 9 / 4, rtol=1e-12)


def test_a_ring_splits_into_equal_sectors(make_ring):
    """Exact: 72 frames, a sector ends where the chord passes 1/4 of the depth 1.08: 15.5 degrees, so after 4 frames."""
    ring = make_ring(count=72)
    sector = split_sequence(score_frames(ring.visibility, 16.0, 9.0), 1.0)
    np.testing.assert_array_equal(np.bincount(sector), 18 * [4])


def test_a_standing_camera_makes_one_sector(make_ring):
    """Property: no motion, no new keyframe."""
    score = score_frames(make_ring(count=9, turns=0).visibility, 16.0, 9.0)
    assert split_sequence(score, 1.0).max() == 0
    assert cluster_photos(score, 1.0).max() == 0


def test_photo_clusters_do_not_depend_on_a_path(make_ring):
    """Property: shuffled, every photo is within the threshold of its cluster's centre, and centres are apart."""
    ring = make_ring(count=72)
    order = np.random.default_rng(2).permutation(72)
    score = score_frames(ring.visibility, 16.0, 9.0)[np.ix_(order, order)]
    sector = cluster_photos(score, 1.0)
    for number in range(sector.max() + 1):
        members = np.flatnonzero(sector == number)
        assert min(score[centre, members].max() for centre in members) <= 1
    # Sectors reach 15.5 degrees to either side of a centre at most, and centres are over 15.5 degrees apart.
    assert 360 / 31 <= sector.max() + 1 <= 360 / 15.5


def test_photos_without_points_end_the_clustering(make_ring):
    """Exact: two photos that see no point add most, are taken once each, and nothing is added after them."""
    ring = make_ring(count=12)
    depth, seen = ring.visibility.depth.copy(), ring.visibility.seen.copy()
    depth[[3, 7]], seen[[3, 7]] = np.nan, False
    visibility = type(ring.visibility)(ring.visibility.centres, ring.visibility.xyz, depth, seen)
    score = score_frames(visibility, 16.0, 9.0)
    np.testing.assert_array_equal(np.diag(score), 0)
    # 30 degrees apart, each is a sector of its own.
    np.testing.assert_array_equal(np.bincount(cluster_photos(score, 1.0)), 12 * [1])
    # A diagonal that is not zero must not keep it going either.
    assert cluster_photos(score + 9 * np.eye(12), 1.0).max() <= 11


@pytest.mark.parametrize(("count", "frames"), [(12, 4), (18, 4), (24, 3), (30, 2), (60, 2)])
def test_sectors_shorten_until_there_are_as_many_as_asked_for(make_ring, count, frames):
    """Exact: 72 frames make 18 sectors of 4; the score of a third of the threshold is passed after 2."""
    score = score_frames(make_ring(count=72).visibility, 16.0, 9.0)
    sector = divide_finely_enough(split_sequence, score, 1.0, 0.35, count)
    np.testing.assert_array_equal(np.bincount(sector), 72 // frames * [frames])
