"""Oracle: frames between others get their pose, and patches make poses exact, on pictures with known cameras."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from room import HIGH, LENS, LOW, render, walk

from threedfs.geometry.rigid import camera_centres, make_transform, rotation_angle
from threedfs.poses.keypoints import describe_image
from threedfs.poses.refinement import RefinementRule, observe_patches, refine_scene
from threedfs.poses.resection import ResectionRule, resect_frames
from threedfs.poses.scene import Scene, make_scene, observation_errors

COUNT = 9
MAPPED = [0, 2, 4, 6, 8]
RULE = RefinementRule(
    patch_points=2000,
    patch_radius=6,
    patch_span=4,
    patch_angle=np.radians(30),
    patch_shift=4.0,
    patch_correlation=0.85,
    patch_observations=30,
    loss_width=1.0,
    max_bend=np.radians(8),
)
RESECTION = ResectionRule(followed_points=300, max_error=4.0, min_inliers=15, followed_share=0.25)


@pytest.fixture(scope="module")
def truth():
    return walk(COUNT, 0.5)


@pytest.fixture(scope="module")
def pictures(truth):
    return [render(pose) for pose in truth]


@pytest.fixture(scope="module")
def images(pictures):
    return np.stack([picture[..., 0] for picture in pictures])


@pytest.fixture(scope="module")
def scene(truth, pictures):
    """Points on the floor, seen by the mapped frames half a pixel off, as keypoints would."""
    rng = np.random.default_rng(0)
    found = describe_image(pictures[4], max_features=800, min_contrast=0.005)
    rays = np.column_stack([LENS.normalise(found.pixels), np.ones(len(found.pixels))]) @ truth[4][:3, :3]
    centre = -truth[4][:3, :3].T @ truth[4][:3, 3]
    slabs = np.stack([(LOW - centre) / rays, (HIGH - centre) / rays])
    beside = slabs.min(0).max(-1) > slabs.max(0).min(-1)  # of the box
    rays = rays[beside & (rays[:, 2] < -0.3)]
    xyz = centre - rays * (centre[2] / rays[:, 2])[:, None]
    points, frames, pixels = [], [], []
    for frame in MAPPED:
        in_camera = xyz @ truth[frame][:3, :3].T + truth[frame][:3, 3]
        seen = LENS.denormalise(in_camera[:, :2] / in_camera[:, 2:])
        shown = np.flatnonzero(np.all((seen >= 0) & (seen <= (319, 239)), axis=1))
        points.append(shown)
        frames.append(np.full(len(shown), frame))
        pixels.append(seen[shown] + rng.normal(0, 0.5, (len(shown), 2)))
    lenses, poses = dict.fromkeys(MAPPED, LENS), {frame: truth[frame] for frame in MAPPED}
    tracks = (np.concatenate(points), np.concatenate(frames), np.concatenate(pixels))
    return make_scene(lenses, poses, xyz, np.zeros((len(xyz), 3), np.uint8), *tracks)


def turned(found, exact):
    """Return the largest angle between poses and the true ones, degrees."""
    return max(np.degrees(rotation_angle(pose[:3, :3] @ exact[frame][:3, :3].T)) for frame, pose in found.items())


def with_poses(scene: Scene, poses):
    return replace(scene, cam_from_world=poses, lenses=dict.fromkeys(poses, LENS))


def test_a_frame_between_others_gets_its_pose(scene, images, truth):
    found = resect_frames(scene, images, MAPPED, RESECTION, seed=0, threads=1)
    assert sorted(found) == [1, 3, 5, 7]
    step = np.linalg.norm(np.diff(camera_centres(truth), axis=0), axis=1).min()
    for frame, pose in found.items():
        away = np.linalg.norm(camera_centres([pose]) - camera_centres([truth[frame]]))
        assert away < 0.1 * step
    assert turned(found, truth) < 0.3


def test_a_blank_frame_between_others_sees_nothing(scene, images, truth):
    blank = images.copy()
    blank[3] = 128
    found = resect_frames(scene, blank, MAPPED, RESECTION, seed=0, threads=1)
    poses = dict(sorted({**scene.cam_from_world, **found}.items()))
    refined = refine_scene(with_poses(scene, poses), blank, RULE, refine_poses=True, refine_lens=False, threads=1)
    assert sorted(refined.cam_from_world) == [0, 1, 2, 4, 5, 6, 7, 8]


def test_a_frame_whose_neighbours_have_no_pose_gets_none(scene, images):
    poses = {frame: scene.cam_from_world[frame] for frame in (0, 2)}
    found = resect_frames(with_poses(scene, poses), images, MAPPED, RESECTION, seed=0, threads=1)
    assert sorted(found) == [1, 3]


def test_all_frames_see_points_and_patches_fit_better_than_keypoints(scene, images, truth):
    whole = with_poses(scene, dict(enumerate(truth)))
    seen = observe_patches(whole, images, RULE, threads=1)
    assert np.bincount(seen.points.track_frame, minlength=COUNT).min() > 100
    refined = refine_scene(whole, images, RULE, refine_poses=False, refine_lens=False, threads=1)
    assert np.median(observation_errors(refined)) < 0.3 * np.median(observation_errors(scene))
    np.testing.assert_allclose(np.median(np.abs(refined.points.xyz[:, 2])), 0, atol=0.005)  # the floor


def test_poses_become_exact(scene, images, truth):
    rng = np.random.default_rng(1)
    poses = {}
    for frame, pose in enumerate(truth):
        turn, _ = cv2.Rodrigues(rng.normal(0, np.radians(0.15), 3))
        poses[frame] = make_transform(turn @ pose[:3, :3], pose[:3, 3])
    before = relative_turns(poses, truth)
    refined = refine_scene(with_poses(scene, poses), images, RULE, refine_poses=True, refine_lens=False, threads=1)
    assert sorted(refined.cam_from_world) == list(range(COUNT))
    assert relative_turns(refined.cam_from_world, truth) < 0.3 * before


def relative_turns(poses, truth):
    """Return the largest error of the rotation from one frame to the next, degrees: the world may be turned."""
    return max(
        np.degrees(
            rotation_angle(
                (poses[frame + 1][:3, :3] @ poses[frame][:3, :3].T)
                @ (truth[frame + 1][:3, :3] @ truth[frame][:3, :3].T).T
            )
        )
        for frame in range(COUNT - 1)
    )


def test_a_scene_that_would_bend_is_left_as_it_was(scene, images, truth):
    strict = replace(RULE, max_bend=0.0)
    whole = with_poses(scene, dict(enumerate(truth)))
    assert refine_scene(whole, images, strict, refine_poses=True, refine_lens=False, threads=1) is whole


def test_a_scene_is_left_as_it_was_where_patches_see_less_than_keypoints(scene, images, truth):
    strict = replace(RULE, patch_correlation=0.9999)
    whole = with_poses(scene, dict(enumerate(truth)))
    assert refine_scene(whole, images, strict, refine_poses=True, refine_lens=False, threads=1) is whole


def test_nothing_depends_on_threads(scene, images):
    results = []
    for threads in (1, 3):
        added = resect_frames(scene, images, MAPPED, RESECTION, seed=0, threads=threads)
        poses = dict(sorted({**scene.cam_from_world, **added}.items()))
        refined = refine_scene(
            with_poses(scene, poses), images, RULE, refine_poses=True, refine_lens=True, threads=threads
        )
        results.append((refined.points.xyz.tobytes(), np.array(list(refined.cam_from_world.values())).tobytes()))
    assert results[0] == results[1]
