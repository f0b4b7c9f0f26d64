"""Oracle, property, exact: undistorted images and their valid pixels."""

import cv2
import numpy as np
import pytest
from threedfs.frames.undistort import assign_cameras, undistort_image, valid_pixels

from threedfs.errors import UserError
from threedfs.geometry.distortion import distort, undistort
from threedfs.geometry.projection import pixel_grid
from threedfs.types import Camera

CAMERA = Camera(160, 120, 150.0, 148.0, 82.0, 57.0)
LENSES = [(-0.25, 0.05), (0.2, 0.0), (0.1, -0.1)]


def pattern(u, v):
    """A smooth image, (H, W, 3) float, of any pixel position."""
    waves = [np.sin(u / 7) * np.cos(v / 9), np.cos(u / 11 + v / 13), np.sin((u - v) / 10)]
    return 128 + 90 * np.stack(waves, axis=-1)


def film(camera, lens):
    """The raw frame that shows `pattern` through a lens: each raw pixel looks up where it came from."""
    u, v = pixel_grid(camera)
    points = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy], axis=-1)
    ideal = undistort(points, lens)
    return pattern(ideal[..., 0] * camera.fx + camera.cx, ideal[..., 1] * camera.fy + camera.cy)


@pytest.mark.parametrize("lens", LENSES)
def test_undistorting_recovers_the_scene(lens):
    raw = np.rint(film(CAMERA, lens)).astype(np.uint8)
    image = undistort_image(raw, CAMERA, lens)
    valid = valid_pixels(CAMERA, lens)
    assert valid.mean() > 0.7
    expected = pattern(*pixel_grid(CAMERA))
    # Two roundings to whole grey levels, and cubic interpolation of waves of over 40 pixels in steps of 1/32 pixel.
    assert np.abs(image - expected)[valid].max() < 2.0


@pytest.mark.parametrize("lens", LENSES)
def test_agrees_with_opencv(lens):
    raw = np.rint(film(CAMERA, lens)).astype(np.uint8)
    matrix, lens4 = CAMERA.px_from_cam, np.array([*lens, 0, 0])
    columns, rows = cv2.initUndistortRectifyMap(matrix, lens4, None, matrix, (160, 120), cv2.CV_32FC1)
    expected = cv2.remap(raw, columns, rows, cv2.INTER_CUBIC)
    valid = valid_pixels(CAMERA, lens)
    # The maps agree to float32; a rounding of a position may tip a grey level.
    assert np.abs(undistort_image(raw, CAMERA, lens).astype(int) - expected)[valid].max() <= 1


@pytest.mark.parametrize("lens", [(0.2, 0.0), (0.4, -0.2)])
def test_valid_pixels_do_not_depend_on_what_lies_outside(lens):
    raw = np.random.default_rng(0).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    columns, rows = pixel_grid(CAMERA)
    points = np.stack([(columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy], axis=-1)
    u, v = np.moveaxis(distort(points, lens) * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy), -1, 0)
    maps = (np.nan_to_num(u, nan=-99).astype(np.float32), np.nan_to_num(v, nan=-99).astype(np.float32))
    black = cv2.remap(raw, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    valid = valid_pixels(CAMERA, lens)
    np.testing.assert_array_equal(undistort_image(raw, CAMERA, lens)[valid], black[valid])
    assert not valid.all()


def test_without_distortion_the_image_is_the_same():
    raw = np.random.default_rng(0).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    np.testing.assert_array_equal(undistort_image(raw, CAMERA, (0.0, 0.0)), raw)
    assert valid_pixels(CAMERA, (0.0, 0.0)).all()


def test_frames_without_pose_take_the_nearest_camera():
    other = Camera(160, 120, 100.0, 100.0, 80.0, 60.0)
    cameras = assign_cameras(list("abcdef"), (120, 160), {"b": CAMERA, "e": other})
    assert cameras == [CAMERA, CAMERA, CAMERA, other, other, other]


def test_cameras_of_another_size_are_refused():
    with pytest.raises(UserError, match=r"camera of frame a: expected 80x60 .* got 160x120"):
        assign_cameras(["a"], (60, 80), {"a": CAMERA})


def test_no_camera_at_all_is_refused():
    with pytest.raises(UserError, match="at least one frame"):
        assign_cameras(["a"], (120, 160), {})
