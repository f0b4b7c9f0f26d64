"""Exact and regression: what happens at the border to COLMAP: import order, half pixels, cameras."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pycolmap
import pytest
from orbit import LENS

from threedfs.colmap.features import extract_features
from threedfs.colmap.lens import colmap_from_px, guess_colmap_camera, make_colmap_camera, read_colmap_camera
from threedfs.types import Camera


def test_zlib_works_in_a_process_that_imports_colmap_first():
    """Importing pycolmap before zlib makes the first call of zlib abort the process."""
    program = (
        "import threedfs.colmap.features, zlib, gzip, numpy, cv2\n"
        "assert zlib.decompress(zlib.compress(b'frame' * 1000)) == b'frame' * 1000\n"
        "assert gzip.decompress(gzip.compress(b'frame')) == b'frame'\n"
        "assert cv2.imencode('.png', numpy.zeros((64, 64), numpy.uint8))[0]\n"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("centre", [(40.0, 30.0), (51.3, 37.6)])
def test_a_blob_is_found_at_its_pixel_centre(centre):
    v, u = np.mgrid[:80, :100]
    blob = 40 + 180 * np.exp(-((u - centre[0]) ** 2 + (v - centre[1]) ** 2) / (2 * 3.0**2))
    image = np.repeat(np.rint(blob).astype(np.uint8)[..., None], 3, axis=2)
    (found,) = extract_features([image], max_features=100, min_contrast=0.005, threads=1)
    # Half a pixel would be 0.5: SIFT's own bias on a symmetric blob is under 0.1.
    assert np.linalg.norm(found.pixels - centre, axis=1).min() < 0.1
    nearest = np.linalg.norm(found.pixels - centre, axis=1).argmin()
    assert np.all(found.colors[nearest] >= 210)


def test_colmap_projects_to_the_same_pixel_half_a_pixel_off():
    rng = np.random.default_rng(0)
    ideal = rng.uniform(-0.4, 0.4, (50, 2))
    theirs = make_colmap_camera(LENS, 1).img_from_cam(np.column_stack([ideal, np.ones(50)]))
    np.testing.assert_allclose(theirs, colmap_from_px(LENS.denormalise(ideal)), atol=1e-9)  # rounding


def test_lens_survives_the_way_through_colmap():
    assert read_colmap_camera(make_colmap_camera(LENS, 1)) == LENS


def test_a_guess_has_its_centre_in_the_middle_of_the_image():
    guessed = read_colmap_camera(guess_colmap_camera(640, 480, 1.2, 1))
    assert guessed.camera == Camera(640, 480, 768.0, 768.0, 319.5, 239.5)


def test_other_than_radial_distortion_is_refused():
    camera = pycolmap.Camera.create_from_model_id(1, pycolmap.CameraModelId.OPENCV_FISHEYE, 500.0, 640, 480)
    with pytest.raises(ValueError, match="OPENCV_FISHEYE"):
        read_colmap_camera(camera)


def test_features_do_not_depend_on_threads():
    rng = np.random.default_rng(3)
    images = [
        np.repeat(np.kron(rng.integers(0, 256, (12, 16)), np.ones((10, 10)))[..., None], 3, axis=2).astype(np.uint8)
        for _ in range(5)
    ]
    one = extract_features(images, max_features=500, min_contrast=0.005, threads=1)
    two = extract_features(images, max_features=500, min_contrast=0.005, threads=2)
    for left, right in zip(one, two, strict=True):
        assert len(left.pixels) > 50
        assert left.pixels.tobytes() == right.pixels.tobytes()
        assert left.descriptors.tobytes() == right.descriptors.tobytes()


def test_the_largest_features_are_kept_and_no_more_than_asked_for():
    rng = np.random.default_rng(4)
    coarse = np.kron(rng.integers(0, 256, (12, 16)), np.ones((20, 20)))
    image = np.repeat((0.7 * coarse + 0.3 * rng.integers(0, 256, coarse.shape))[..., None], 3, axis=2).astype(np.uint8)
    (every,) = extract_features([image], max_features=5000, min_contrast=0.005, threads=1)
    (some,) = extract_features([image], max_features=60, min_contrast=0.005, threads=1)
    assert len(every.pixels) > 200 and len(some.pixels) == 60
    assert {tuple(pixel) for pixel in some.pixels} <= {tuple(pixel) for pixel in every.pixels}


def test_a_blank_image_has_no_features():
    (found,) = extract_features([np.full((60, 80, 3), 90, np.uint8)], max_features=9, min_contrast=0.005, threads=1)
    assert found.pixels.shape == (0, 2) and found.descriptors.shape == (0, 128)
