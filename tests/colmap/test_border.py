"""Exact and regression: what happens at the border to COLMAP: import order, half pixels, cameras."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pycolmap
import pytest
from orbit import LENS

from threedfs.colmap.lens import colmap_from_px, guess_colmap_camera, make_colmap_camera, read_colmap_camera
from threedfs.types import Camera


def test_zlib_works_in_a_process_that_imports_colmap_first():
    """Importing pycolmap before zlib makes the first call of zlib abort the process."""
    program = (
        "import threedfs.colmap.graph, zlib, gzip, numpy, cv2\n"
        "assert zlib.decompress(zlib.compress(b'frame' * 1000)) == b'frame' * 1000\n"
        "assert gzip.decompress(gzip.compress(b'frame')) == b'frame'\n"
        "assert cv2.imencode('.png', numpy.zeros((64, 64), numpy.uint8))[0]\n"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


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
