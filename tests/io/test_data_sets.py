"""Exact: images, cameras, depth and masks in the layouts of published data sets, as the test writes them."""

from __future__ import annotations

import io
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from threedfs.errors import UserError
from threedfs.frames.masks import find_masks
from threedfs.geometry.rigid import invert, make_transform
from threedfs.io.frames import read_frames
from threedfs.io.given_cameras import read_given_cameras
from threedfs.io.truth import read_depth_image
from threedfs.io.truth_files import choose_spread, find_depth_images
from threedfs.job import Job
from threedfs.params.frames import FramesParams
from threedfs.poses.given import find_cameras
from threedfs.progress import Progress
from threedfs.stages import frames as stage

REDKITCHEN = Path(__file__).resolve().parents[3] / "shared" / "data" / "rgbd_redkitchen"
SHAPE = (24, 32)
COUNT = 4
INTRINSICS = (570.3, 571.0, 15.5, 12.0)
PATTERN = np.kron(np.indices((6, 8)).sum(0) % 2, np.ones((4, 4))).astype(np.uint8)
IMAGES = [np.stack([90 + 40 * PATTERN + 20 * n, 60 * PATTERN, 200 - 30 * PATTERN], -1) for n in range(COUNT)]
DEPTHS = [np.arange(SHAPE[0] * SHAPE[1], dtype=np.uint16).reshape(SHAPE) + 900 + n for n in range(COUNT)]
QUATERNIONS = Rotation.from_rotvec([[0.1 * n, -0.2, 0.05 * n] for n in range(COUNT)]).as_quat()  # w last
CENTRES = np.array([[0.1 * n, 0.02, -0.3 * n] for n in range(COUNT)])
POSES = [make_transform(Rotation.from_quat(q).as_matrix(), c) for q, c in zip(QUATERNIONS, CENTRES, strict=True)]


def read_images(source, folder, masks=None):
    params = FramesParams(min_frames=2, blank_contrast=0.0)
    job = Job(Progress("frames", io.StringIO()))
    stage.run(source=source, masks=masks, frames=folder / "frames.zarr.zip", params=params, job=job)
    return read_frames(folder / "frames.zarr.zip")


def check(store, cameras, depth_folder, scale):
    found = find_cameras(cameras, store.names, store.indices, numbered=store.ordered)
    depths = find_depth_images(depth_folder, store.names)
    assert list(found) == list(range(COUNT)) and list(depths) == list(store.names)
    for number, name in enumerate(store.names):
        np.testing.assert_array_equal(store.image(name), IMAGES[number])
        np.testing.assert_allclose(found[number].cam_from_world, invert(POSES[number]), atol=1e-12)
        camera = found[number].lens.camera
        assert (camera.fx, camera.fy, camera.cx, camera.cy) == INTRINSICS
        np.testing.assert_allclose(read_depth_image(depths[name], scale), DEPTHS[number] / scale)


def write_seven_scenes(folder, *, intrinsics=True):
    folder.mkdir(parents=True)
    for number in range(COUNT):
        stem = folder / f"frame-{8 * number:06d}"
        cv2.imwrite(f"{stem}.color.png", IMAGES[number][..., ::-1])
        cv2.imwrite(f"{stem}.depth.png", DEPTHS[number])
        np.savetxt(f"{stem}.pose.txt", POSES[number])
    if intrinsics:
        fx, fy, cx, cy = INTRINSICS
        np.savetxt(folder / "camera-intrinsics.txt", [[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
    return folder


def test_seven_scenes_in_one_folder(tmp_path):
    folder = write_seven_scenes(tmp_path / "seq-01")
    check(read_images(folder, tmp_path), read_given_cameras(folder), folder, 1000.0)


def test_seven_scenes_with_intrinsics_from_the_configuration(tmp_path):
    folder = write_seven_scenes(tmp_path / "seq-01", intrinsics=False)
    with pytest.raises(UserError, match=r"expected intrinsics of the cameras, .* got none"):
        read_given_cameras(folder)
    check(read_images(folder, tmp_path), read_given_cameras(folder, INTRINSICS), folder, 1000.0)


def test_intrinsics_from_the_configuration_go_before_those_of_the_folder(tmp_path):
    folder = write_seven_scenes(tmp_path / "seq-01")
    assert read_given_cameras(folder, (500.0, 501.0, 3.0, 4.0))[0].lens.camera.fy == 501


def test_frames_that_the_tracker_lost_have_no_camera(tmp_path):
    folder = write_seven_scenes(tmp_path / "seq-01")
    np.savetxt(folder / "frame-000008.pose.txt", np.full((4, 4), -np.inf))
    names = [camera.name for camera in read_given_cameras(folder)]
    assert names == ["frame-000000.color", "frame-000016.color", "frame-000024.color"]


def test_a_rotation_that_is_nearly_one_becomes_the_nearest(tmp_path):
    folder = write_seven_scenes(tmp_path / "seq-01")
    pose = np.array(POSES[1])
    pose[:3, :3] *= 1.0005
    np.savetxt(folder / "frame-000008.pose.txt", pose)
    np.testing.assert_allclose(read_given_cameras(folder)[1].cam_from_world, invert(POSES[1]), atol=1e-12)
    pose[:3, :3] *= 1.1
    np.savetxt(folder / "frame-000008.pose.txt", pose)
    with pytest.raises(UserError, match=r"frame-000008.pose.txt: expected a rotation .* it probably carries a scale"):
        read_given_cameras(folder)


def write_rgbd_scenes(root):
    images, clouds = root / "imgs" / "scene_01", root / "pc"
    images.mkdir(parents=True)
    clouds.mkdir()
    for number in range(COUNT):
        cv2.imwrite(str(images / f"{number:05d}-color.png"), IMAGES[number][..., ::-1])
        cv2.imwrite(str(images / f"{number:05d}-depth.png"), DEPTHS[number])
    lines = [[q[3], q[0], q[1], q[2], *c] for q, c in zip(QUATERNIONS, CENTRES, strict=True)]
    np.savetxt(clouds / "01.pose", lines)
    return images, clouds / "01.pose"


def test_rgbd_scenes_v2(tmp_path):
    images, poses = write_rgbd_scenes(tmp_path)
    check(read_images(images, tmp_path), read_given_cameras(poses, INTRINSICS), images, 10000.0)


def test_object_videos(tmp_path):
    folder = tmp_path / "dragon"
    (folder / "masks").mkdir(parents=True)
    with av.open(str(folder / "video.mp4"), "w") as container:
        stream = container.add_stream("libx264", rate=30, options={"crf": "12"})
        stream.width, stream.height, stream.pix_fmt = SHAPE[1], SHAPE[0], "yuv420p"
        for image in IMAGES:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(image.astype(np.uint8), format="rgb24")))
        container.mux(stream.encode())
    cv2.imwrite(str(folder / "masks" / "000002.png"), 255 * np.eye(*SHAPE, dtype=np.uint8))
    store = read_images(folder / "video.mp4", tmp_path, folder / "masks")
    assert store.names == ("000000", "000001", "000002", "000003")
    assert find_masks(folder / "masks", store.names, numbered=True) == {"000002": folder / "masks" / "000002.png"}
    # frames differ by 20 grey levels in red; colour is coded at half the resolution
    assert [round((store.image(name)[..., 0].mean() - IMAGES[0][..., 0].mean()) / 20) for name in store.names] == [
        *range(COUNT)
    ]


def test_refuses_poses_that_are_none(tmp_path):
    _, poses = write_rgbd_scenes(tmp_path)
    with pytest.raises(UserError, match=r"by the sequence's key intrinsics, got none"):
        read_given_cameras(poses)
    poses.write_text("1 0 0 0 0.5 0.5 0.5\n0 0 0 2 0 0 0\n")
    with pytest.raises(UserError, match=r"expected a unit quaternion, w first, .* in line 2, got '0 0 0 2 0 0 0'"):
        read_given_cameras(poses, INTRINSICS)
    poses.write_text("1 0 0 0 here\n")
    with pytest.raises(UserError, match="in line 1, got '1 0 0 0 here'"):
        read_given_cameras(poses, INTRINSICS)
    folder = write_seven_scenes(tmp_path / "seq-01")
    (folder / "frame-000000.pose.txt").write_text("1 2 3")
    with pytest.raises(UserError, match=r"frame-000000.pose.txt: expected a 4x4 matrix"):
        read_given_cameras(folder)


def test_refuses_intrinsics_for_cameras_that_have_their_own(tmp_path):
    (tmp_path / "0.txt").write_text("CONTOUR\n500 0 300 0\n0 500 200 0\n0 0 1 4\n")
    assert len(read_given_cameras(tmp_path)) == 1
    with pytest.raises(UserError, match=r"got cameras that state their own; remove that key"):
        read_given_cameras(tmp_path, INTRINSICS)


@pytest.mark.parametrize(
    ("count", "chosen"), [(1, "d"), (2, "ag"), (3, "adg"), (5, "acdfg"), (7, "abcdefg"), (9, "abcdefg")]
)
def test_frames_are_chosen_evenly_spread(count, chosen):
    assert choose_spread("abcdefg", count) == list(chosen)


@pytest.mark.skipif(not REDKITCHEN.is_dir(), reason="needs ../shared/data/rgbd_redkitchen beside the project")
def test_redkitchen_is_read_in_place():
    cameras = read_given_cameras(REDKITCHEN)
    assert len(cameras) == 125 and cameras[0].lens.camera.fx == 585
    depths = find_depth_images(REDKITCHEN, [camera.name for camera in cameras])
    assert list(depths) == [camera.name for camera in cameras]
    depth = read_depth_image(depths["frame-000000.color"], 1000.0)
    assert depth.shape == (480, 640) and 0.4 < np.nanmin(depth) < np.nanmax(depth) < 5
