"""Exact tests of motion blur on images whose motion is known in closed form."""

import numpy as np
import pytest

from threedfs.geometry.rigid import make_transform
from threedfs.synthetic.blur import image_motion, smear
from threedfs.types import Camera

CAMERA = Camera(64, 48, 60.0, 60.0, 31.5, 23.5)
STILL = np.eye(4)


def sideways(distance):
    return make_transform(np.eye(3), np.array([distance, 0.0, 0.0]))


def test_motion_of_a_wall_is_focal_length_times_way_over_depth():
    depth = np.full(CAMERA.shape, 3.0)
    motion = image_motion(CAMERA, depth, sideways(-0.1), sideways(0.1), STILL)
    np.testing.assert_allclose(motion[..., 0], 60 * 0.2 / 3, atol=1e-12)
    np.testing.assert_allclose(motion[..., 1], 0, atol=1e-12)


def test_turning_moves_all_depths_alike():
    cosine, sine = np.cos(0.05), np.sin(0.05)
    turned = make_transform(np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]]), np.zeros(3))
    near, far = (image_motion(CAMERA, np.full(CAMERA.shape, d), STILL, turned, STILL) for d in (1.0, 9.0))
    np.testing.assert_allclose(near, far, atol=1e-10)
    assert near[23, 31, 0] == pytest.approx(60 * np.tan(0.05), rel=0.02)


def test_without_motion_nothing_changes():
    image = np.random.default_rng(0).uniform(size=(*CAMERA.shape, 3))
    depth = np.ones(CAMERA.shape)
    np.testing.assert_allclose(smear(image, depth, np.zeros((*CAMERA.shape, 2))), image, atol=1e-15)


def test_a_ramp_stays_a_ramp_and_a_line_becomes_as_wide_as_the_motion():
    depth, motion = np.ones(CAMERA.shape), np.zeros((*CAMERA.shape, 2))
    motion[..., 0] = 8.0
    ramp = np.repeat(np.tile(np.arange(64.0), (48, 1))[..., None], 3, axis=-1)
    np.testing.assert_allclose(smear(ramp, depth, motion)[:, 5:-5], ramp[:, 5:-5], atol=1e-12)
    line = np.zeros((*CAMERA.shape, 3))
    line[:, 30] = 1.0
    blurred = smear(line, depth, motion)
    np.testing.assert_allclose(blurred.sum(axis=1), 1, atol=1e-12)
    columns = np.flatnonzero(blurred[10, :, 0])
    assert columns.min() >= 30 - 5 and columns.max() <= 30 + 5 and len(columns) >= 8


def test_what_is_nearer_does_not_bleed_into_a_background_that_moves():
    image, depth = np.zeros((*CAMERA.shape, 3)), np.full(CAMERA.shape, 4.0)
    image[:, 20:40], depth[:, 20:40] = 1.0, 1.0
    motion = np.zeros((*CAMERA.shape, 2))
    motion[..., 0] = np.where(depth > 2, 10.0, 0.0)
    np.testing.assert_allclose(smear(image, depth, motion), image, atol=1e-12)
