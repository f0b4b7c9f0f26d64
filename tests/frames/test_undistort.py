"""Oracle, property, exact: undistorted images, their valid pixels, and masks back in the source."""

import cv2
import numpy as np
import pytest
from skimage.draw import polygon2mask

from threedfs.errors import UserError
from threedfs.frames.distortion import distort, undistort
from threedfs.frames.undistort import assign_cameras, undistort_image, valid_pixels, warp_to_source
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


def disc(camera, centre, radius):
    u, v = pixel_grid(camera)
    return (u - centre[0]) ** 2 + (v - centre[1]) ** 2 < radius**2


@pytest.mark.parametrize("lens", [(0.0, 0.0), *LENSES])
def test_a_mask_goes_to_the_source_and_comes_back(lens):
    mask = disc(CAMERA, (70, 60), 35)
    source = warp_to_source(mask, CAMERA, lens, (360, 480))
    working = cv2.resize(source.astype(np.float32), (160, 120), interpolation=cv2.INTER_AREA)
    back = undistort_image(np.repeat(working[..., None], 3, axis=-1), CAMERA, lens)[..., 0] > 0.5
    # The outline may move by a fraction of a pixel: 220 pixels of it, of 3,850.
    assert np.mean(back != mask) * mask.size < 30
    assert np.count_nonzero(source) / 9 == pytest.approx(np.count_nonzero(mask), rel=0.25)


@pytest.mark.parametrize("lens", LENSES)
def test_the_source_mask_lies_where_the_lens_images_it(lens):
    mask = disc(CAMERA, (110, 40), 20)
    source = warp_to_source(mask, CAMERA, lens, (240, 320))
    angle = np.linspace(0, 2 * np.pi, 1000)
    edge = np.stack([110 + 20 * np.cos(angle), 40 + 20 * np.sin(angle)], axis=-1)
    focal, centre = np.array([CAMERA.fx, CAMERA.fy]), np.array([CAMERA.cx, CAMERA.cy])
    imaged = distort((edge - centre) / focal, lens) * focal + centre
    outline = (imaged + 0.5) * 2 - 0.5
    expected = polygon2mask((240, 320), outline[:, ::-1])
    # The working mask is a stair-stepped disc: its own pixels decide the outline, half a working pixel either way.
    overlap = np.count_nonzero(source & expected) / np.count_nonzero(source | expected)
    assert overlap > 0.96
    # Averaged over the outline nothing of that is left: a wrong pixel convention would shift the mask by 0.5.
    shift = np.mean(np.argwhere(source), axis=0) - np.mean(np.argwhere(expected), axis=0)
    assert np.abs(shift).max() < 0.1


def test_a_full_mask_fills_the_source_without_distortion():
    assert warp_to_source(np.ones((120, 160), bool), CAMERA, (0.0, 0.0), (300, 400)).all()


def test_what_the_working_frame_does_not_show_is_not_masked():
    # Barrel: the corners of the source lie outside the undistorted frame.
    lens = (-0.3, 0.0)
    source = warp_to_source(np.ones((120, 160), bool), CAMERA, lens, (120, 160))
    assert source[57, 82] and not source[0, 0] and not source[-1, -1]


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
