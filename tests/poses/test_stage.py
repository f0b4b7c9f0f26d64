"""End to end: the stage on rendered pictures against their cameras; the same bytes for any number of threads."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from room import LENS, render, walk

from threedfs.errors import UserError
from threedfs.geometry.rigid import invert, rotation_angle
from threedfs.geometry.similarity import align
from threedfs.io.calibration import Calibration, write_calibration
from threedfs.io.frames import Frame, write_frames
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.job import Job
from threedfs.params.features import FeaturesParams
from threedfs.params.poses import PosesParams
from threedfs.poses.normalise import observed_depths
from threedfs.progress import Progress
from threedfs.stages import poses as stage
from threedfs.stages.features import run as find_features

FRAMES = 8


@pytest.fixture(scope="module")
def truth():
    return walk(FRAMES, 0.8)


@pytest.fixture(scope="module")
def pictures(truth):
    return [render(pose) for pose in truth]


def store_frames(path, pictures, *, ordered=True):
    frames = (
        Frame(f"{5 * number:06d}", 5 * number, number / 6 if ordered else float("nan"), 1.0, picture)
        for number, picture in enumerate(pictures)
    )
    write_frames(path, frames, {}, ordered=ordered, source_shape=(480, 640))
    return path


def make_job(threads):
    return Job(Progress("poses", io.StringIO()), {"made": "in a test"}, threads)


def run(folder, pictures, *, threads=1, cameras=None, calibration=None, ordered=True, described=75, **settings):
    folder.mkdir(exist_ok=True)
    frames, job = store_frames(folder / "frames.zarr.zip", pictures, ordered=ordered), make_job(threads)
    find_features(
        frames=frames, features=folder / "features.zarr.zip", params=FeaturesParams(max_frames=described), job=job
    )
    stage.run(
        frames=frames,
        features=folder / "features.zarr.zip",
        cameras=cameras,
        calibration=calibration,
        poses=folder / "poses.json",
        points=folder / "points.zarr.zip",
        intrinsics=None,
        params=PosesParams(**settings),
        job=job,
    )
    return read_poses(folder / "poses.json"), read_points(folder / "points.zarr.zip")


def check_against(found, truth, centre_error, degrees):
    """Compare with the true cameras after a similarity alignment of the centres."""
    centres = np.array([view.centre for view in found.views])
    true_centres = np.array([-pose[:3, :3].T @ pose[:3, 3] for pose in truth])
    similarity = align(centres, true_centres)
    extent = np.linalg.norm(np.ptp(true_centres, axis=0))
    assert np.linalg.norm(similarity.apply(centres) - true_centres, axis=1).max() < centre_error * extent
    for view, pose in zip(found.views, truth, strict=True):
        turned = similarity.apply_to_pose(view.cam_from_world)[:3, :3] @ pose[:3, :3].T
        assert rotation_angle(turned) < np.radians(degrees)


@pytest.fixture(scope="module")
def estimated_folder(tmp_path_factory):
    return tmp_path_factory.mktemp("poses") / "one"


@pytest.fixture(scope="module")
def estimated(estimated_folder, pictures):
    return run(estimated_folder, pictures)


def test_cameras_are_estimated(estimated, truth):
    found, points = estimated
    assert [view.name for view in found.views] == [f"{5 * number:06d}" for number in range(FRAMES)]
    assert found.unposed == ()
    # Eight small pictures, lens unknown: about ten times what is measured (0.05 %, 0.03 degrees).
    check_against(found, truth, 0.01, 0.5)
    assert found.views[0].camera.fx == pytest.approx(LENS.camera.fx, rel=0.03)
    assert found.quality["registered_share"] == 1.0
    assert found.quality["step_ratio"] < 1.5
    assert len(points.xyz) > 200


def test_the_scene_has_mean_inverse_depth_one(estimated):
    found, points = estimated
    depth = observed_depths(points, {number: view.cam_from_world for number, view in enumerate(found.views)})
    assert np.mean(1 / depth) == pytest.approx(1, rel=1e-9)  # rounding of JSON and float64
    assert points.track_frame.max() < len(found.views)


def test_bytes_do_not_depend_on_threads(tmp_path, estimated_folder, estimated, pictures):
    run(tmp_path / "two", pictures, threads=2)
    for name in ("features.zarr.zip", "poses.json", "points.zarr.zip"):
        assert (estimated_folder / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_a_gap_of_blurred_frames_is_bridged(tmp_path, pictures, truth):
    blurred = [np.full_like(pictures[0], 128)] * 3
    found, _ = run(
        tmp_path / "gap", pictures[:4] + blurred + pictures[4:], overlap=2, gap_overlap=5, min_registered=0.7
    )
    assert found.unposed == ("000020", "000025", "000030")
    check_against(found, truth, 0.02, 1.0)


@pytest.fixture(scope="module")
def dense(tmp_path_factory):
    """Twice as many frames, keypoints in every other one."""
    poses = walk(2 * FRAMES, 0.8)
    pictures = [render(pose) for pose in poses]
    folder = tmp_path_factory.mktemp("dense")
    return folder, pictures, poses, run(folder / "one", pictures, described=FRAMES)


def test_frames_without_keypoints_get_a_pose_and_see_points(dense):
    _, _, poses, (found, points) = dense
    assert found.unposed == ()
    check_against(found, poses, 0.01, 0.5)
    seen = np.bincount(points.track_frame, minlength=2 * FRAMES)
    assert seen[1::2].min() > 0.5 * seen[::2].min() > 30


def test_bytes_of_frames_without_keypoints_do_not_depend_on_threads(dense):
    folder, pictures, *_ = dense
    run(folder / "three", pictures, threads=3, described=FRAMES)
    for name in ("features.zarr.zip", "poses.json", "points.zarr.zip"):
        assert (folder / "one" / name).read_bytes() == (folder / "three" / name).read_bytes()


def test_given_cameras_see_points_without_keypoints_too(tmp_path, dense):
    _, pictures, poses, _ = dense
    entries = [{"name": f"{5 * number}", "cam_to_world": invert(pose).tolist()} for number, pose in enumerate(poses)]
    lens = {"width": 640, "height": 480, "fx": 660.0, "fy": 660.0, "cx": 320.0, "cy": 240.0}
    (tmp_path / "cameras.json").write_text(json.dumps({**lens, "frames": entries}))
    found, points = run(tmp_path / "run", pictures, cameras=tmp_path / "cameras.json", described=FRAMES)
    assert len(found.views) == 2 * FRAMES
    assert np.bincount(points.track_frame, minlength=2 * FRAMES).min() > 30


def test_photos_without_order(tmp_path, pictures, truth):
    found, _ = run(tmp_path / "photos", pictures[::2], ordered=False)
    check_against(found, truth[::2], 0.02, 1.0)
    assert "step_ratio" not in found.quality


def test_a_calibration_is_kept(tmp_path, pictures, truth):
    doubled = LENS.resize(640, 480).camera  # boards were taken at the source's size
    write_calibration(tmp_path / "calibration.json", Calibration(doubled, 0.0, 0.0, 0.1, 9), {})
    found, _ = run(tmp_path / "run", pictures, calibration=tmp_path / "calibration.json")
    assert all(view.camera == LENS.camera for view in found.views)
    assert found.distortion == (0.0, 0.0)
    check_against(found, truth, 0.005, 0.3)


def test_given_cameras_are_kept_and_points_triangulated(tmp_path, pictures, truth):
    entries = [
        {"name": "x", "video_frame": 5 * number, "cam_to_world": invert(pose).tolist()}
        for number, pose in enumerate(truth)
        if number != 3
    ]
    lens = {"width": 640, "height": 480, "fx": 660.0, "fy": 660.0, "cx": 320.0, "cy": 240.0}
    (tmp_path / "cameras.json").write_text(json.dumps({**lens, "frames": entries}))
    found, points = run(tmp_path / "run", pictures, cameras=tmp_path / "cameras.json")
    assert found.unposed == ("000015",)
    scale = found.scene_from_input.scale
    for view in found.views:
        pose = truth[int(view.name) // 5]
        np.testing.assert_allclose(view.camera.px_from_cam, LENS.camera.px_from_cam, atol=1e-9)  # rounding
        np.testing.assert_allclose(view.cam_from_world[:3, :3], pose[:3, :3], atol=1e-9)
        np.testing.assert_allclose(view.cam_from_world[:3, 3], scale * pose[:3, 3], atol=1e-9)
    xyz = points.xyz / scale
    on_floor = np.abs(xyz[:, 2]) < 0.02
    on_box = (np.abs(np.abs(xyz[:, :2]).max(1) - 0.4) < 0.02) | (np.abs(xyz[:, 2] - 0.7) < 0.02)
    # Every surface is the floor or a side of the box; wrong matches along an epipolar line are rare.
    assert (on_floor | on_box).mean() > 0.97
    assert on_box.sum() > 50


def test_a_static_camera_is_told(tmp_path, pictures):
    rng = np.random.default_rng(0)
    still = [(pictures[0] + rng.normal(0, 2, pictures[0].shape)).clip(0, 255).astype(np.uint8) for _ in range(4)]
    with pytest.raises(UserError, match="static"):
        run(tmp_path / "static", still)


def test_a_camera_that_turns_on_the_spot_is_told(tmp_path, truth):
    turned = []
    for angle in np.linspace(-0.15, 0.15, 5):
        turn = np.eye(4)
        turn[:3, :3] = [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
        turned.append(render(turn @ truth[0]))
    with pytest.raises(UserError, match="parallax"):
        run(tmp_path / "turning", turned)


def test_blank_frames_are_told(tmp_path):
    with pytest.raises(UserError, match="blank"):
        run(tmp_path / "blank", [np.full((240, 320, 3), 128, np.uint8)] * 8)


def test_cameras_of_other_pictures_are_told(tmp_path, pictures, truth):
    entries = [
        {"name": f"{5 * number}", "cam_to_world": invert(pose).tolist()} for number, pose in enumerate(truth[::-1])
    ]
    lens = {"width": 640, "height": 480, "fx": 660.0, "fy": 660.0, "cx": 320.0, "cy": 240.0}
    (tmp_path / "cameras.json").write_text(json.dumps({**lens, "frames": entries}))
    with pytest.raises(UserError, match="do not fit the images"):
        run(tmp_path / "run", pictures, cameras=tmp_path / "cameras.json")
    assert not (tmp_path / "run" / "poses.json").exists()


def test_a_video_of_two_scenes_is_told(tmp_path, pictures):
    other = [255 - picture[::-1, ::-1] for picture in pictures]
    with pytest.raises(UserError, match="frames to get a pose"):
        run(tmp_path / "cut", pictures[:4] + [np.ascontiguousarray(picture) for picture in other[4:]])
