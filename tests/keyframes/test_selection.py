"""The choice among the frames of all sectors."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.keyframes.selection import choose_keyframes, viewing_directions


def angles_between(directions, chosen):
    """Angle in degrees of every frame to its nearest keyframe."""
    return np.degrees(np.arccos(np.clip((directions @ directions[chosen].T).max(axis=1), -1, 1)))


def choose(ring, sharpness=None, forced=(), count=24, max_gap=180.0, per_sector=3):
    frames = len(ring.views)
    mask = np.zeros(frames, bool)
    mask[list(forced)] = True
    return choose_keyframes(
        sector=np.arange(frames) // per_sector,
        directions=viewing_directions(ring.views, ring.points.xyz),
        sharpness=np.ones(frames) if sharpness is None else sharpness,
        forced=mask,
        count=count,
        max_gap=max_gap,
    )


def test_directions_point_from_the_common_centre(make_ring):
    """Exact: all axes meet in the origin, so directions are the normalised centres."""
    ring = make_ring(count=12)
    centres = ring.visibility.centres
    expected = centres / np.linalg.norm(centres, axis=1, keepdims=True)
    # The median of the random points, a hundredth of the pull, is under 0.02 from the origin.
    np.testing.assert_allclose(viewing_directions(ring.views, ring.points.xyz), expected, atol=1e-3)


def test_directions_of_parallel_cameras_are_finite(make_ring):
    """Property: cameras that look the same way have no common point; the sparse points stand in."""
    views = make_ring(count=5, turns=0).views
    assert np.isfinite(viewing_directions(views, make_ring().points.xyz)).all()


def test_the_sharpest_frame_of_every_sector_is_taken(make_ring):
    """Exact: with room for all sectors, each gives its sharpest frame."""
    ring = make_ring(count=72)
    sharpness = np.random.default_rng(0).random(72)
    expected = 3 * np.arange(24) + sharpness.reshape(24, 3).argmax(axis=1)
    np.testing.assert_array_equal(choose(ring, sharpness), expected)


def test_a_blurred_side_is_not_dropped(make_ring):
    """Property: frames of one half a thousand times blurrier; its largest gap is like that of the other half."""
    ring = make_ring(count=72)
    sharpness = np.where(np.arange(72) < 36, 1.0, 1e-3)
    chosen = choose(ring, sharpness, count=12)
    directions = viewing_directions(ring.views, ring.points.xyz)
    # 12 keyframes on the ring: farthest-point filling leaves gaps of at most twice the even 30 degrees.
    assert angles_between(directions, chosen).max() <= 30 + 5
    assert (chosen >= 36).sum() >= 4


@pytest.mark.parametrize("count", [2, 5, 12, 24])
def test_forced_frames_count_and_gaps_are_filled(make_ring, count):
    """Property: forced frames are in, the number is kept, and more keyframes never widen a gap."""
    ring = make_ring(count=72)
    chosen = choose(ring, forced=(7, 50), count=count)
    assert {7, 50} <= set(chosen.tolist()) and len(chosen) == count == len(set(chosen.tolist()))
    directions = viewing_directions(ring.views, ring.points.xyz)
    fewer = choose(ring, forced=(7, 50), count=max(count - 1, 2))
    assert angles_between(directions, chosen).max() <= angles_between(directions, fewer).max()


def test_more_forced_frames_than_the_number_are_all_kept(make_ring):
    """Exact: no other frame is added where the forced ones leave no gap."""
    ring = make_ring(count=72)
    forced = range(0, 72, 2)
    np.testing.assert_array_equal(choose(ring, forced=forced, count=10, max_gap=30.0), list(forced))


def test_a_side_without_forced_frames_is_filled_beyond_the_number(make_ring):
    """Property: annotated frames all on one side do not leave the other empty."""
    ring = make_ring(count=72)
    chosen = choose(ring, forced=range(0, 30), count=30, max_gap=30.0)
    directions = viewing_directions(ring.views, ring.points.xyz)
    # Sectors of 15 degrees offer one frame each, so a frame may be that much farther than the offered one.
    assert angles_between(directions, chosen).max() <= 30 + 15
    assert len(chosen) > 30
