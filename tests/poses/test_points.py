"""Exact and property: scale of the scene, tracks and their filters, epipolar errors."""

from __future__ import annotations

import numpy as np
import pytest
from orbit import LENS, make_orbit, true_matches

from threedfs.geometry.rigid import invert, make_transform
from threedfs.poses.epipolar import agreeing_matches, epipolar_errors
from threedfs.poses.normalise import find_scale, observed_depths, rescale_points
from threedfs.poses.pairs import sequential_pairs
from threedfs.poses.quality import measure_points
from threedfs.poses.tracks import good_points, keep_points, keep_well_seen, triangulation_angles
from threedfs.types import SparsePoints

POSES = {0: np.eye(4), 2: make_transform(np.eye(3), [-1.0, 0, 0]), 5: make_transform(np.eye(3), [1.0, 0, 0])}
"""Cameras at x = 0, 1 and -1 that look along z."""
POINTS = SparsePoints(
    xyz=np.array([[0, 0, 2.0], [0.5, 0, 4.0], [0, 0, -1.0], [0, 0, 50.0]]),
    rgb=np.arange(12, dtype=np.uint8).reshape(4, 3),
    error=np.array([0.5, 0.2, 0.1, 3.0]),
    track_point=np.array([0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 3]),
    track_frame=np.array([0, 2, 5, 0, 2, 0, 2, 5, 0, 2, 5]),
)
BOUNDS = {"max_error": 5.0, "min_angle": 0.0, "min_track": 2}


def test_mean_inverse_depth_is_one_after_scaling():
    points = keep_points(POINTS, np.array([True, True, False, True]))
    scene_from_input = find_scale(points, POSES)
    posed = sorted(POSES)
    scaled = rescale_points(points, scene_from_input, posed)
    poses = {number: scene_from_input.apply_to_pose(POSES[frame]) for number, frame in enumerate(posed)}
    assert np.mean(1 / observed_depths(scaled, poses)) == pytest.approx(1, rel=1e-12)  # rounding
    np.testing.assert_array_equal(scene_from_input.rotation, np.eye(3))
    np.testing.assert_array_equal(scene_from_input.translation, 0)


def test_frames_are_numbered_among_the_posed_ones():
    scaled = rescale_points(POINTS, find_scale(POINTS, POSES), sorted(POSES))
    np.testing.assert_array_equal(scaled.track_frame[:3], [0, 1, 2])


def test_the_widest_angle_counts():
    angles = triangulation_angles(POINTS, POSES)
    assert angles[0] == pytest.approx(2 * np.arctan(0.5))
    assert angles[1] == pytest.approx(2 * np.arctan(0.125))


@pytest.mark.parametrize(
    ("bounds", "good"),
    [
        ({}, [True, True, False, True]),  # the third is behind the cameras
        ({"max_error": 1.0}, [True, True, False, False]),
        ({"min_angle": np.radians(20)}, [True, False, False, False]),
        ({"min_track": 3}, [True, False, False, True]),
    ],
)
def test_bad_points_are_told(bounds, good):
    np.testing.assert_array_equal(good_points(POINTS, POSES, **{**BOUNDS, **bounds}), good)


@pytest.mark.parametrize(("min_points", "kept"), [(1, 2), (3, 3)])
def test_short_tracks_stay_only_where_points_are_few(min_points, kept):
    found = keep_well_seen(POINTS, POSES, max_error=5.0, min_angle=0.0, min_track=3, min_points=min_points)
    assert len(found.xyz) == kept


def test_kept_points_keep_what_they_carry():
    found = keep_points(POINTS, np.array([False, True, False, True]))
    np.testing.assert_array_equal(found.xyz, POINTS.xyz[[1, 3]])
    np.testing.assert_array_equal(found.rgb, POINTS.rgb[[1, 3]])
    np.testing.assert_array_equal(found.track_point, [0, 0, 1, 1, 1])
    np.testing.assert_array_equal(found.track_frame, [0, 2, 0, 2, 5])


def test_figures_weigh_points_by_their_observations():
    figures = measure_points(keep_points(POINTS, np.array([True, True, False, False])), POSES)
    assert figures["points"] == 2 and figures["observations"] == 5
    assert figures["track_length"] == 2.5
    assert figures["reprojection_error"] == pytest.approx((3 * 0.5 + 2 * 0.2) / 5)


def test_no_points_have_figures_too():
    assert measure_points(keep_points(POINTS, np.zeros(4, bool)), POSES)["points"] == 0


def test_true_matches_have_no_epipolar_error_and_shifted_ones_theirs():
    relative = make_transform(np.eye(3), [1.0, 0, 0])
    first = np.random.default_rng(0).uniform(-0.3, 0.3, (20, 2))
    second = first + np.linspace(0.1, 0.4, 20)[:, None] * [1, 0]
    np.testing.assert_allclose(epipolar_errors(relative, first, second), 0, atol=1e-15)
    # Epipolar lines are rows: a shift across them is shared by the two frames, so Sampson's is shift / sqrt(2).
    np.testing.assert_allclose(
        epipolar_errors(relative, first, second + np.array([0, 0.01])), 0.01 / np.sqrt(2), rtol=1e-9
    )


def test_matches_that_contradict_the_poses_are_dropped_through_distortion():
    orbit = make_orbit(6, 0.2)
    matches = true_matches(orbit, sequential_pairs(6, 2))
    wrong = {
        pair: np.concatenate([found, np.roll(found, 9, axis=0) * [1, 0] + found * [0, 1]])
        for pair, found in matches.items()
    }
    kept = agreeing_matches(
        [frame.pixels for frame in orbit.features],
        wrong,
        dict.fromkeys(range(6), LENS),
        orbit.poses,
        max_error=0.5,
        min_matches=15,
    )
    for pair, found in kept.items():
        right = (found[:, None] == matches[pair]).all(-1).any(-1)
        assert right.sum() == len(matches[pair])
        # A wrong match lies within half a pixel of its line by chance in about one of fifty.
        assert right.mean() > 0.9
    assert set(kept) == set(matches)


def test_pairs_of_wrong_poses_are_dropped():
    orbit = make_orbit(4, 0.2)
    turned = {frame: invert(pose) for frame, pose in orbit.poses.items()}
    matches = true_matches(orbit, sequential_pairs(4, 1))
    pixels = [frame.pixels for frame in orbit.features]
    kept = agreeing_matches(pixels, matches, dict.fromkeys(range(4), LENS), turned, max_error=0.5, min_matches=100)
    assert kept == {}
