"""Exact: cameras in the four given formats are read back; rejection of what is not usable."""

from __future__ import annotations

import json

import numpy as np
import pycolmap
import pytest

from threedfs.colmap.lens import make_colmap_camera
from threedfs.errors import UserError
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection_matrix import decompose_projection
from threedfs.geometry.rigid import invert, look_at
from threedfs.io.given_cameras import read_given_cameras
from threedfs.poses.given import GivenCamera, find_cameras, fit_lens, shared_distortion
from threedfs.types import Camera

LENS = Lens(Camera(640, 480, 610.0, 600.0, 320.25, 238.5), 0.05, -0.01)
POSES = [look_at(np.array([3.0, y, 1.0]), np.zeros(3), np.array([0, 0, 1.0])) for y in (-1.0, 0.0, 1.0)]
NAMES = ["000000", "000010", "000020"]


def write_cameras_json(path):
    entries = [{"name": name, "cam_to_world": invert(pose).tolist()} for name, pose in zip(NAMES, POSES, strict=True)]
    content = {
        "width": 640,
        "height": 480,
        "fx": 610.0,
        "fy": 600.0,
        "cx": 320.75,
        "cy": 239.0,
        "k1": 0.05,
        "k2": -0.01,
    }
    path.write_text(json.dumps({**content, "frames": entries}))
    return path


def write_transforms(path):
    entries = [
        {"file_path": f"images/{name}.png", "transform_matrix": (invert(pose) @ np.diag([1, -1, -1, 1])).tolist()}
        for name, pose in zip(NAMES, POSES, strict=True)
    ]
    content = {"w": 640, "h": 480, "fl_x": 610.0, "fl_y": 600.0, "cx": 320.75, "cy": 239.0, "k1": 0.05, "k2": -0.01}
    path.write_text(json.dumps({**content, "frames": entries}))
    return path


def write_colmap(folder, *, text):
    folder.mkdir(parents=True)
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(make_colmap_camera(LENS, 1))
    for number, (name, pose) in enumerate(zip(NAMES, POSES, strict=True), start=1):
        image = pycolmap.Image(name=f"{name}.jpg", camera_id=1, image_id=number)
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(pose[:3]))
    (model.write_text if text else model.write_binary)(folder)
    return folder


def write_contour(folder):
    folder.mkdir()
    for name, pose in zip(NAMES, POSES, strict=True):
        matrix = -2.5 * LENS.camera.px_from_cam @ pose[:3]  # scale and sign are free
        rows = "\n".join(" ".join(repr(float(value)) for value in row) for row in matrix)
        (folder / f"{name}.txt").write_text(f"CONTOUR\n{rows}\n")
    return folder


def check(cameras, lens):
    assert [camera.name for camera in cameras] == NAMES
    for camera, pose in zip(cameras, POSES, strict=True):
        # Printed and inverted in float64.
        np.testing.assert_allclose(camera.cam_from_world, pose, atol=1e-12)
        np.testing.assert_allclose(
            list(vars(camera.lens.camera).values()), list(vars(lens.camera).values()), rtol=1e-12
        )
        assert (camera.lens.k1, camera.lens.k2) == (lens.k1, lens.k2)


def test_cameras_json(tmp_path):
    check(read_given_cameras(write_cameras_json(tmp_path / "any name.json")), LENS)


def test_transforms_json(tmp_path):
    check(read_given_cameras(write_transforms(tmp_path / "transforms.json")), LENS)


def test_a_folder_with_transforms_json(tmp_path):
    write_transforms(tmp_path / "transforms.json")
    check(read_given_cameras(tmp_path), LENS)


@pytest.mark.parametrize("text", [True, False])
@pytest.mark.parametrize("inside", ["", "sparse/0", "sparse"])
def test_colmap_model(tmp_path, text, inside):
    write_colmap(tmp_path / "model" / inside, text=text)
    check(read_given_cameras(tmp_path / "model"), LENS)


def test_contour_matrices(tmp_path):
    check(read_given_cameras(write_contour(tmp_path / "calib")), Lens(Camera(0, 0, 610.0, 600.0, 320.25, 238.5)))


def test_views_without_an_image_are_read_too(tmp_path):
    path = write_cameras_json(tmp_path / "cameras.json")
    content = json.loads(path.read_text())
    content["frames"][1]["rgb"] = None
    content["frames"][2]["video_frame"] = 20
    path.write_text(json.dumps(content))
    cameras = read_given_cameras(path)
    assert len(cameras) == 3
    assert [camera.video_frame for camera in cameras] == [None, None, 20]


def test_an_opening_angle_stands_for_a_focal_length(tmp_path):
    path = write_transforms(tmp_path / "transforms.json")
    content = json.loads(path.read_text())
    del content["fl_x"], content["fl_y"]
    content["camera_angle_x"] = 2 * np.arctan(320 / 500)
    path.write_text(json.dumps(content))
    assert read_given_cameras(path)[0].lens.camera.fx == pytest.approx(500)


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("cameras.json", "{", "check the file"),
        ("cameras.json", '{"frames": []}', "at least one camera"),
        ("cameras.json", '{"frames": [{"name": "a", "cam_to_world": [[1]]}]}', "expected shape"),
        ("cameras.json", "[1, 2]", "check the file"),
        ("0000.txt", "CONTOUR 1 2 3", "12 numbers"),
        ("0000.txt", "CONTOUR" + " 0" * 12, "singular"),
        ("notes.txt", "nothing", "found none of them"),
        ("images.txt", "nothing", "COLMAP"),
    ],
)
def test_unusable_cameras_are_refused(tmp_path, name, text, sentence):
    (tmp_path / name).write_text(text)
    with pytest.raises(UserError, match=sentence):
        read_given_cameras(tmp_path / name if name.endswith("json") else tmp_path)


def test_tangential_distortion_is_refused(tmp_path):
    path = write_transforms(tmp_path / "transforms.json")
    path.write_text(json.dumps({**json.loads(path.read_text()), "p1": 0.001}))
    with pytest.raises(UserError, match="p1"):
        read_given_cameras(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(UserError, match="found nothing"):
        read_given_cameras(tmp_path / "none.json")


def test_a_mirrored_pose_is_refused(tmp_path):
    path = write_cameras_json(tmp_path / "cameras.json")
    content = json.loads(path.read_text())
    content["frames"][0]["cam_to_world"] = np.diag([1.0, 1, -1, 1]).tolist()
    path.write_text(json.dumps(content))
    with pytest.raises(UserError, match="rotation"):
        read_given_cameras(path)


def test_projection_is_split_whatever_its_sign():
    for factor in (1.0, -3.0):
        intrinsics, pose = decompose_projection(factor * LENS.camera.px_from_cam @ POSES[0][:3])
        np.testing.assert_allclose(intrinsics, LENS.camera.px_from_cam, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(pose, POSES[0], atol=1e-12)


def cameras_named(names, video_frames=None):
    frames = video_frames or [None] * len(names)
    return [GivenCamera(name, frame, LENS, np.eye(4)) for name, frame in zip(names, frames, strict=True)]


@pytest.mark.parametrize(
    ("names", "video_frames", "numbered", "found"),
    [
        (["c", "a", "x"], None, False, {0: "a", 2: "c"}),
        (["0", "10", "7"], None, True, {0: "0", 2: "10"}),
        (["p", "q", "r"], [10, 5, 99], True, {1: "q", 2: "p"}),
    ],
)
def test_cameras_are_found_by_name_or_video_frame(names, video_frames, numbered, found):
    frames = ["000000", "000005", "000010"] if numbered else ["a", "b", "c"]
    result = find_cameras(cameras_named(names, video_frames), frames, np.array([0, 5, 10]), numbered=numbered)
    assert {number: camera.name for number, camera in result.items()} == found


def test_names_that_do_not_agree_are_refused():
    with pytest.raises(UserError, match="make the names agree"):
        find_cameras(cameras_named(["x", "y"]), ["a", "b"], np.arange(2), numbered=False)


def test_a_lens_is_scaled_about_the_corner_of_the_image():
    half = fit_lens(LENS, (480, 640), (240, 320))
    assert (half.camera.fx, half.camera.fy) == (305.0, 300.0)
    # The pixel u of the full image is at (u + 0.5) / 2 - 0.5 of the half one.
    assert (half.camera.cx, half.camera.cy) == ((320.25 + 0.5) / 2 - 0.5, (238.5 + 0.5) / 2 - 0.5)
    assert (half.k1, half.k2) == (LENS.k1, LENS.k2)


def test_a_lens_without_size_is_that_of_the_source():
    lens = Lens(Camera(0, 0, 610.0, 600.0, 320.25, 238.5))
    fitted = fit_lens(lens, (480, 640), (240, 320))
    assert fitted.camera == fit_lens(LENS, (480, 640), (240, 320)).camera


def test_a_lens_of_another_shape_is_refused():
    with pytest.raises(UserError, match="cropped or rotated"):
        fit_lens(LENS, (640, 480), (640, 480))


def test_one_distortion_is_required():
    assert shared_distortion([LENS, LENS]) == (0.05, -0.01)
    with pytest.raises(UserError, match="one radial distortion"):
        shared_distortion([LENS, Lens(LENS.camera)])


def test_distortion_is_undone():
    pixels = np.random.default_rng(0).uniform(0, 480, (40, 2))
    np.testing.assert_allclose(LENS.denormalise(LENS.normalise(pixels)), pixels, atol=1e-9)  # converged iteration
