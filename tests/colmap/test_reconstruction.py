"""Oracle: poses and points of a made-up orbit are recovered; property: to the bit, run after run."""

from __future__ import annotations

import numpy as np
import pytest
from orbit import LENS, make_orbit, true_matches

from threedfs.colmap.mapping import map_frames
from threedfs.colmap.triangulation import triangulate
from threedfs.colmap.verification import verify_matches
from threedfs.geometry.rigid import invert, rotation_angle
from threedfs.geometry.similarity import align
from threedfs.poses.pairs import sequential_pairs

SETTINGS = {"width": 640, "height": 480, "focal_factor": 1.2, "seed": 0}


def map_orbit(orbit, matches, lens=None):
    """Run the mapper with the tests' settings."""
    return map_frames(orbit.features, matches, lens=lens, min_inliers=15, min_inlier_share=0.15, **SETTINGS)


@pytest.fixture(scope="module")
def orbit():
    return make_orbit(14, 0.5, noise=0.3)


@pytest.fixture(scope="module")
def matches(orbit):
    return true_matches(orbit, sequential_pairs(14, 4))


def test_poses_and_lens_are_recovered(orbit, matches):
    mapped = map_orbit(orbit, matches)
    assert mapped.parts == (14,)
    centres = np.array([-pose[:3, :3].T @ pose[:3, 3] for pose in mapped.model.cam_from_world.values()])
    similarity = align(centres, orbit.centres)
    # Keypoints are 0.3 px off, a thousandth of the view; hundreds of them average that out.
    assert np.linalg.norm(similarity.apply(centres) - orbit.centres, axis=1).max() < 0.02
    assert mapped.lens.camera.fx == pytest.approx(600, rel=0.01)
    assert mapped.lens.k1 == pytest.approx(0.04, abs=0.01)
    assert (mapped.lens.camera.cx, mapped.lens.camera.cy) == (319.5, 239.5)


def test_known_lens_is_kept(orbit, matches):
    assert map_orbit(orbit, matches, LENS).lens == LENS


def test_mapping_is_the_same_to_the_bit(orbit, matches):
    one, two = (map_orbit(orbit, matches).model for _ in range(2))
    assert all(one.cam_from_world[k].tobytes() == two.cam_from_world[k].tobytes() for k in one.cam_from_world)
    assert one.points.xyz.tobytes() == two.points.xyz.tobytes()


def test_the_largest_part_is_taken_when_the_frames_split(orbit):
    pairs = [pair for pair in sequential_pairs(14, 4) if (pair[0] < 4) == (pair[1] < 4)]
    mapped = map_orbit(orbit, true_matches(orbit, pairs))
    assert sorted(mapped.model.cam_from_world) == list(range(4, 14))


def test_mapping_goes_on_with_more_matches(orbit, matches):
    started = map_orbit(orbit, {pair: found for pair, found in matches.items() if pair[1] < 10})
    assert sorted(started.model.cam_from_world) == list(range(10))
    more = map_frames(
        orbit.features, matches, lens=None, min_inliers=15, min_inlier_share=0.15, start=started, **SETTINGS
    )
    assert sorted(more.model.cam_from_world) == list(range(14))
    assert more.lens.camera.fx == pytest.approx(600, rel=0.01)


def test_closing_a_loop_merges_the_tracks_of_both_rounds():
    loop = make_orbit(24, 1.15, noise=0.3)
    open_path = map_orbit(loop, true_matches(loop, sequential_pairs(24, 3)))
    closures = true_matches(loop, sequential_pairs(24, 3) + [(frame, frame + 20) for frame in range(4)])
    closed = map_frames(
        loop.features, closures, lens=None, min_inliers=15, min_inlier_share=0.15, start=open_path, **SETTINGS
    )
    assert len(closed.model.points.xyz) < len(open_path.model.points.xyz)
    assert len(closed.model.points.track_point) > 0.98 * len(open_path.model.points.track_point)


def test_nothing_is_mapped_without_matches(orbit):
    assert map_orbit(orbit, {}) is None


def test_points_of_known_poses_lie_where_they_are():
    orbit = make_orbit(8, 0.25)
    model = triangulate(
        orbit.features,
        true_matches(orbit, sequential_pairs(8, 3)),
        dict.fromkeys(range(8), LENS),
        orbit.poses,
        seed=0,
    )
    for number, pose in orbit.poses.items():
        np.testing.assert_allclose(model.cam_from_world[number], pose, atol=1e-12)
    first = np.searchsorted(model.points.track_point, np.arange(len(model.points.xyz)))
    true = np.array(
        [
            orbit.xyz[orbit.seen[frame][feature]]
            for frame, feature in zip(model.points.track_frame[first], model.track_feature[first], strict=True)
        ]
    )
    assert len(true) > 200
    # Keypoints are stored in float32: 3e-5 px of 600, seen from 3 units away under a few degrees.
    np.testing.assert_allclose(model.points.xyz, true, atol=1e-4)
    assert np.all(model.points.rgb == 100)


def test_frames_without_a_pose_are_left_out_of_triangulation():
    orbit = make_orbit(6, 0.2)
    posed = {number: pose for number, pose in orbit.poses.items() if number != 2}
    pairs = [pair for pair in sequential_pairs(6, 3) if 2 not in pair]
    model = triangulate(orbit.features, true_matches(orbit, pairs), dict.fromkeys(posed, LENS), posed, seed=0)
    assert sorted(model.cam_from_world) == sorted(posed)
    assert 2 not in model.points.track_frame


@pytest.mark.parametrize("lens", [None, LENS])
def test_verification_drops_false_matches_and_does_not_depend_on_threads(orbit, lens):
    matches = true_matches(orbit, sequential_pairs(14, 2))
    wrong = {pair: np.array(found) for pair, found in matches.items()}
    for found in wrong.values():
        found[:40, 1] = np.roll(found[:40, 1], 7)
    one, two = (
        verify_matches(orbit.features, wrong, lens=lens, max_error=2.0, threads=threads, **SETTINGS)
        for threads in (1, 2)
    )
    for pair, found in one.items():
        assert found.matches.tobytes() == two[pair].matches.tobytes()
        right = (found.matches[:, None] == matches[pair]).all(-1).any(-1)
        # A false match survives only by chance, near its epipolar line.
        assert right.mean() > 0.97 and right.sum() > 0.8 * (len(matches[pair]) - 40)
        if lens is not None:
            true = orbit.poses[pair[1]] @ invert(orbit.poses[pair[0]])
            assert rotation_angle(found.second_from_first[:3, :3] @ true[:3, :3].T) < np.radians(1)
