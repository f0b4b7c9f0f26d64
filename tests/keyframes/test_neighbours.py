"""The frames that a keyframe is matched against."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.keyframes.neighbours import NeighbourRule, choose_neighbours, measure_pairs
from threedfs.keyframes.visibility import Visibility

RULE = NeighbourRule(
    count=10, min_count=4, min_angle=2.0, max_angle=12.0, widest_angle=35.0, min_overlap=0.3, min_shared=5
)


def test_pairs_are_measured_on_the_ring(make_ring):
    """Exact to the size of the object: angles at the points are those between the cameras."""
    ring = make_ring(count=72)
    overlap, angle = measure_pairs(ring.visibility, 0)
    np.testing.assert_array_equal(overlap, 1)
    centres = ring.visibility.centres / np.linalg.norm(ring.visibility.centres, axis=1, keepdims=True)
    between = np.degrees(np.arccos(np.clip(centres[:8] @ centres[0], -1, 1)))
    # Points lie up to 0.1 from the centre, cameras 1.08 away: the median angle is off by a few percent at most.
    np.testing.assert_allclose(angle[:8], between, rtol=0.05, atol=1e-5)


@pytest.mark.parametrize("count", [54, 72, 150, 360, 1000])
def test_neighbours_surround_the_keyframe(make_ring, count):
    """Property: at any frame rate, ten neighbours on both sides, at useful angles where the video has them."""
    ring = make_ring(count=count)
    keyframe = count // 2
    chosen = choose_neighbours(ring.visibility, keyframe, RULE)
    assert len(set(chosen.tolist())) == 10 and keyframe not in chosen
    assert 4 <= (chosen < keyframe).sum() <= 6
    _, angle = measure_pairs(ring.visibility, keyframe)
    if count >= 300:
        # Enough frames between 2 and 12 degrees: none need be outside, but for the soft ends of that range.
        assert angle[chosen].min() > 1.5 and angle[chosen].max() < 16
        assert angle[chosen].max() > 8
    assert angle[chosen].max() <= 35


def test_wide_frames_serve_only_to_reach_the_minimum(make_ring):
    """Exact: photos 40 degrees apart, all too wide: the minimum is still taken, the nearest first."""
    ring = make_ring(count=9)
    chosen = choose_neighbours(ring.visibility, 4, RULE)
    assert len(chosen) == RULE.min_count
    assert set(chosen[:2].tolist()) == {3, 5}


def test_fewer_frames_than_asked_for_are_all_taken(make_ring):
    """Exact: three frames give two neighbours."""
    ring = make_ring(count=3, turns=0.05)
    assert set(choose_neighbours(ring.visibility, 1, RULE).tolist()) == {0, 2}


def test_frames_that_see_something_else_are_no_neighbours(make_ring):
    """Property: a frame with a tenth of the keyframe's points in view is passed over for others."""
    ring = make_ring(count=72)
    depth = ring.visibility.depth.copy()
    depth[37, 20:] = np.nan
    visibility = Visibility(ring.visibility.centres, ring.visibility.xyz, depth, ring.visibility.seen)
    assert 37 in choose_neighbours(ring.visibility, 36, RULE)
    assert 37 not in choose_neighbours(visibility, 36, RULE)


def test_a_frame_at_the_same_place_is_worth_nothing(make_ring):
    """Exact: without a baseline there is no depth, so a standing camera has no neighbours."""
    assert len(choose_neighbours(make_ring(count=6, turns=0).visibility, 0, RULE)) == 0


def test_frames_of_another_pass_are_no_neighbours(make_ring):
    """Property: a frame at a good angle that shares no triangulated point may have drifted, so it is passed over."""
    ring = make_ring(count=72)
    seen = ring.visibility.seen.copy()
    seen[37, :] = False
    visibility = Visibility(ring.visibility.centres, ring.visibility.xyz, ring.visibility.depth, seen)
    assert 37 not in choose_neighbours(visibility, 36, RULE)


def test_a_distant_background_does_not_hide_the_baseline(make_ring):
    """Property: many points a hundred times farther away leave the angle that of the near ones."""
    ring = make_ring(count=72)
    far = np.array([0.0, 0.0, 100.0]) + np.random.default_rng(0).normal(size=(600, 3))
    depth = np.hstack([ring.visibility.depth, np.full((72, 600), 100.0)])
    seen = np.ones(depth.shape, bool)
    xyz = np.vstack([ring.visibility.xyz, far])
    _, angle = measure_pairs(Visibility(ring.visibility.centres, xyz, depth, seen), 0)
    _, near_only = measure_pairs(ring.visibility, 0)
    # The background weighs 600 / 100^2 against 200 / 1^2 of the near points: the median moves by one point at most.
    np.testing.assert_allclose(angle, near_only, rtol=0.01, atol=1e-5)


def test_a_turning_camera_has_no_neighbours(make_ring):
    """Property: centres that differ by rounding only are one place, whatever the arc cosine of nearly 1 says."""
    ring = make_ring(count=6, turns=0)
    centres = ring.visibility.centres + 1e-7 * np.random.default_rng(0).normal(size=(6, 3))
    visibility = Visibility(centres, ring.visibility.xyz, ring.visibility.depth, ring.visibility.seen)
    assert len(choose_neighbours(visibility, 0, RULE)) == 0
