"""Property: loop closures are found the second time round, and repeated artwork is not taken for one."""

from __future__ import annotations

import numpy as np
import pytest
from orbit import LENS, make_orbit, true_matches

from threedfs.colmap.triangulation import triangulate
from threedfs.colmap.verification import Verified, verify_matches
from threedfs.geometry.rigid import invert, make_transform
from threedfs.poses.closures import (
    accept_closures,
    agrees_with_path,
    closure_candidates,
    covered_share,
    predict_overlap,
    stays_on_path,
)
from threedfs.poses.matching import match_pairs
from threedfs.poses.pairs import sequential_pairs

FRAMES, TURN = 41, 26  # 41 frames make 1.6 turns: frame k + 25.6 stands where frame k stood
BOUNDS = {"max_rotation": np.radians(8), "max_direction": np.radians(15), "min_cover": 0.1}


@pytest.fixture(scope="module")
def orbit():
    return make_orbit(FRAMES, 1.6 * 40 / 40, noise=0.3, repeats=2)


@pytest.fixture(scope="module")
def model(orbit):
    matches = true_matches(orbit, sequential_pairs(FRAMES, 3))
    return triangulate(orbit.features, matches, dict.fromkeys(range(FRAMES), LENS), orbit.poses, seed=0)


def verify(orbit, pairs):
    """Match and verify pairs as the stage does."""
    matches = match_pairs(
        [frame.descriptors for frame in orbit.features], pairs, max_ratio=0.8, max_angle=0.7, min_matches=15, threads=1
    )
    return verify_matches(
        orbit.features, matches, width=640, height=480, lens=LENS, focal_factor=1.2, max_error=4.0, seed=0, threads=1
    )


def test_candidates_are_frames_that_stand_at_the_same_place_a_turn_later(orbit, model):
    frames, overlap = predict_overlap(model.points, LENS, orbit.poses, max_angle=np.radians(30))
    candidates = closure_candidates(frames, overlap, min_gap=8, min_overlap=0.4, per_frame=2)
    assert len(candidates) >= 2 * 10
    assert all(abs(second - first - 25.6) <= 3 for first, second in candidates)
    assert all(np.bincount([second for _, second in candidates]) <= 2)


def test_overlap_is_symmetric_and_whole_with_itself(orbit, model):
    _, overlap = predict_overlap(model.points, LENS, orbit.poses, max_angle=np.radians(30))
    np.testing.assert_array_equal(overlap, overlap.T)
    np.testing.assert_allclose(np.diag(overlap), 1.0)


def test_true_closures_are_accepted(orbit):
    pairs = [(frame, frame + TURN) for frame in range(0, FRAMES - TURN, 3)]
    assert list(accept_closures(pixels(orbit), verify(orbit, pairs), orbit.poses, (480, 640), **BOUNDS)) == pairs


def test_the_back_of_repeated_artwork_is_rejected(orbit):
    opposite = [(frame, frame + 13) for frame in range(0, FRAMES - 13, 2)]
    matches = match_pairs(
        [frame.descriptors for frame in orbit.features],
        opposite,
        max_ratio=0.8,
        max_angle=0.7,
        min_matches=15,
        threads=1,
    )
    # The artwork does match from behind: without the path it would have been believed.
    assert len(matches) >= 10
    assert accept_closures(pixels(orbit), verify(orbit, opposite), orbit.poses, (480, 640), **BOUNDS) == {}


def test_matches_on_a_small_part_of_the_image_are_rejected(orbit):
    pair = (0, TURN)
    found = verify(orbit, [pair])[pair]
    near = np.linalg.norm(orbit.features[0].pixels[found.matches[:, 0]] - (320, 200), axis=1) < 60
    small = {pair: Verified(found.matches[near], found.second_from_first)}
    assert near.sum() > 15
    assert accept_closures(pixels(orbit), small, orbit.poses, (480, 640), **BOUNDS) == {}


def test_a_pair_without_a_relative_pose_is_rejected(orbit):
    pair = (0, TURN)
    unknown = {pair: Verified(verify(orbit, [pair])[pair].matches, None)}
    assert accept_closures(pixels(orbit), unknown, orbit.poses, (480, 640), **BOUNDS) == {}


@pytest.mark.parametrize(("degrees", "agrees"), [(7.0, True), (9.0, False)])
def test_agreement_is_bounded_by_the_rotation(degrees, agrees):
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    first, second = np.eye(4), make_transform(np.eye(3), [0, 0, 1.0])
    relative = make_transform(rotation, [0, 0, 0.2])
    bounds = {"max_rotation": np.radians(8), "max_direction": np.radians(15)}
    assert agrees_with_path(relative, first, second, **bounds) is agrees


@pytest.mark.parametrize(("degrees", "agrees"), [(14.0, True), (16.0, False), (180.0, False)])
def test_agreement_is_bounded_by_the_direction(degrees, agrees):
    turn = np.radians(degrees)
    relative = make_transform(np.eye(3), [np.sin(turn), 0, np.cos(turn)])
    second = make_transform(np.eye(3), [0, 0, 5.0])
    bounds = {"max_rotation": np.radians(8), "max_direction": np.radians(15)}
    assert agrees_with_path(relative, np.eye(4), second, **bounds) is agrees


def test_cover_is_the_box_of_most_pixels():
    grid = np.stack(np.meshgrid(np.linspace(0, 320, 41), np.linspace(0, 240, 41)), axis=-1).reshape(-1, 2)
    # Nine tenths of half the width by nine tenths of half the height.
    assert covered_share(grid, 640, 480) == pytest.approx(0.2025)
    with_outlier = np.concatenate([grid, [[639.0, 479.0]]])
    assert covered_share(with_outlier, 640, 480) == pytest.approx(0.2025, rel=0.01)


def test_a_path_in_another_world_frame_is_the_same_path(orbit):
    world = orbit.poses[5]
    moved = {frame: pose @ invert(world) for frame, pose in orbit.poses.items()}
    assert stays_on_path(orbit.poses, moved, np.radians(1e-4))


def test_a_folded_path_is_told_from_the_open_one(orbit):
    folded = {frame: orbit.poses[frame % 13] for frame in orbit.poses}
    assert not stays_on_path(orbit.poses, folded, np.radians(8))
    assert not stays_on_path(orbit.poses, {0: orbit.poses[0]}, np.radians(8))


def pixels(orbit):
    """Keypoints of every frame."""
    return [frame.pixels for frame in orbit.features]
