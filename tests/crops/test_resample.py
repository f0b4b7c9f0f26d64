"""Oracle, property, exact: images resampled once, without distortion, and their valid pixels."""

import cv2
import numpy as np
import pytest

from threedfs.crops.resample import find_valid, resample
from threedfs.geometry.distortion import distort, undistort
from threedfs.geometry.lens import Lens
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
def test_resampling_recovers_the_scene(lens):
    raw = np.rint(film(CAMERA, lens)).astype(np.uint8)
    image, valid = resample(raw, Lens(CAMERA, *lens), CAMERA)
    assert valid.mean() > 0.7
    expected = pattern(*pixel_grid(CAMERA))
    # Two roundings to whole grey levels, and cubic interpolation of waves of over 40 pixels in steps of 1/32 pixel.
    assert np.abs(image - expected)[valid].max() < 2.0


@pytest.mark.parametrize("lens", [(0.0, 0.0), *LENSES])
def test_a_crop_shows_its_part_of_the_scene_at_its_own_resolution(lens):
    raw = np.rint(film(CAMERA, lens)).astype(np.uint8)
    crop = Camera(30, 24, CAMERA.fx * 0.6, CAMERA.fy * 0.6, (CAMERA.cx + 0.5 - 60) * 0.6 - 0.5, 20.0)
    image, valid = resample(raw, Lens(CAMERA, *lens), crop)
    u, v = pixel_grid(crop)
    expected = pattern((u - crop.cx) / crop.fx * CAMERA.fx + CAMERA.cx, (v - crop.cy) / crop.fy * CAMERA.fy + CAMERA.cy)
    assert image.shape == (24, 30, 3)
    assert valid.all()
    # Means over squares of 1.7 pixels lower the tops of waves of 44 pixels and more by less than 1 %.
    assert np.abs(image - expected).max() < 3.0


def test_the_frame_itself_comes_out_as_it_is():
    raw = np.random.default_rng(0).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    image, valid = resample(raw, Lens(CAMERA), CAMERA)
    assert np.array_equal(image, raw)
    assert valid.all()


def test_noise_averages_out_in_a_coarser_crop():
    raw = np.random.default_rng(0).normal(128, 20, (480, 640, 3)).clip(0, 255).astype(np.uint8)
    filmed = Camera(640, 480, 600.0, 600.0, 320.0, 240.0)
    crop = Lens(filmed).resize(160, 120).camera
    image, _ = resample(raw, Lens(filmed), crop)
    assert image.std() == pytest.approx(20 / 4, rel=0.1)  # 16 independent pixels for each


@pytest.mark.parametrize("lens", LENSES)
def test_agrees_with_opencv(lens):
    raw = np.rint(film(CAMERA, lens)).astype(np.uint8)
    matrix, lens4 = CAMERA.px_from_cam, np.array([*lens, 0, 0])
    columns, rows = cv2.initUndistortRectifyMap(matrix, lens4, None, matrix, (160, 120), cv2.CV_32FC1)
    expected = cv2.remap(raw, columns, rows, cv2.INTER_CUBIC)
    image, valid = resample(raw, Lens(CAMERA, *lens), CAMERA)
    # The maps agree to float32; a rounding of a position may tip a grey level.
    assert np.abs(image.astype(int) - expected)[valid].max() <= 1


@pytest.mark.parametrize("lens", [(0.2, 0.0), (0.4, -0.2)])
def test_valid_pixels_do_not_depend_on_what_lies_outside(lens):
    raw = np.random.default_rng(0).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    columns, rows = pixel_grid(CAMERA)
    points = np.stack([(columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy], axis=-1)
    u, v = np.moveaxis(distort(points, lens) * (CAMERA.fx, CAMERA.fy) + (CAMERA.cx, CAMERA.cy), -1, 0)
    maps = (np.nan_to_num(u, nan=-99).astype(np.float32), np.nan_to_num(v, nan=-99).astype(np.float32))
    black = cv2.remap(raw, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    white = cv2.remap(raw, *maps, cv2.INTER_CUBIC, borderMode=cv2.BORDER_CONSTANT, borderValue=(255, 255, 255))
    valid = find_valid(Lens(CAMERA, *lens), CAMERA)
    assert 0.2 < valid.mean() < 1
    assert np.array_equal(black[valid], white[valid])


def test_a_crop_beyond_the_frame_is_not_valid_there():
    raw = np.zeros((120, 160, 3), np.uint8)
    crop = Camera(60, 40, CAMERA.fx, CAMERA.fy, CAMERA.cx - 130, CAMERA.cy)  # columns 130 to 189 of 160
    _, valid = resample(raw, Lens(CAMERA), crop)
    assert valid[:, :30].all() and not valid[:, 30:].any()


@pytest.mark.parametrize("lens", [(-0.9, 0.0), (-3.0, 0.0)])
def test_nothing_is_valid_where_the_lens_model_turns_back(lens):
    points = np.stack(pixel_grid(CAMERA), axis=-1) - (CAMERA.cx, CAMERA.cy)
    seen = np.isfinite(distort(points / (CAMERA.fx, CAMERA.fy), lens)).all(-1)
    assert not seen.all()
    assert not find_valid(Lens(CAMERA, *lens), CAMERA)[~seen].any()
