"""Exact and rejection: working resolution and cameras at it."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.frames.scale import scale_camera, shrink, working_shape
from threedfs.types import Camera


def test_shrinking_averages_areas():
    image = np.zeros((4, 6, 3), np.uint8)
    image[:2, :2] = 100
    image[0, 2] = 80
    small = shrink(image, (2, 3))
    assert small[..., 0].tolist() == [[100, 20, 0], [0, 0, 0]]


@pytest.mark.parametrize(
    ("shape", "expected"), [((720, 1280), (540, 960)), ((960, 10), (960, 10)), ((3000, 1), (960, 1))]
)
def test_working_shape(shape, expected):
    assert working_shape(shape, 960) == expected


def test_a_scaled_camera_projects_to_the_scaled_pixel():
    camera = Camera(1280, 720, 1000.0, 990.0, 630.0, 355.0)
    small = scale_camera(camera, (360, 640), "calibration")
    point = np.array([0.2, -0.1, 1.0])
    u, v, _ = camera.px_from_cam @ point
    np.testing.assert_allclose((small.px_from_cam @ point)[:2], [(u + 0.5) / 2 - 0.5, (v + 0.5) / 2 - 0.5], atol=1e-12)
    assert small.shape == (360, 640)


def test_rounding_to_whole_pixels_is_no_other_aspect():
    camera = Camera(1060, 708, 1700.0, 1700.0, 530.0, 354.0)
    assert scale_camera(camera, working_shape(camera.shape, 960), "calibration").width == 960
    assert scale_camera(camera, working_shape(camera.shape, 64), "calibration").height == 43


@pytest.mark.parametrize("shape", [(640, 360), (480, 640), (360, 650)])
def test_another_aspect_is_refused(shape):
    camera = Camera(1280, 720, 1000.0, 990.0, 630.0, 355.0)
    with pytest.raises(UserError, match=r"calibration: expected images of the aspect .* got 1280x720"):
        scale_camera(camera, shape, "calibration")
