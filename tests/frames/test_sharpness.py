"""Property: sharpness falls with blur, whatever the exposure."""

import cv2
import numpy as np
import pytest

from threedfs.frames.sharpness import measure_contrast, measure_sharpness


def texture(seed=0):
    """Detail at many scales, (120, 160, 3) uint8."""
    rng = np.random.default_rng(seed)
    layers = [cv2.resize(rng.normal(0, 1, (120 // s, 160 // s)), (160, 120)) * s for s in (1, 2, 4, 8, 20)]
    grey = np.sum(layers, axis=0)
    grey = 100 + 60 * grey / np.abs(grey).max()
    return np.repeat(np.rint(grey).astype(np.uint8)[..., None], 3, axis=-1)


def test_blur_lowers_it_step_by_step():
    values = [measure_sharpness(texture())]
    values += [measure_sharpness(cv2.GaussianBlur(texture(), (0, 0), sigma)) for sigma in (0.7, 1, 1.5, 2, 3)]
    assert np.all(np.diff(values) < 0)


def test_motion_blur_lowers_it():
    streak = np.full((1, 5), 0.2)
    assert measure_sharpness(cv2.filter2D(texture(), -1, streak)) < 0.9 * measure_sharpness(texture())


@pytest.mark.parametrize(("gain", "offset"), [(0.7, 0), (1.0, 40), (1.4, -20)])
def test_exposure_hardly_changes_it(gain, offset):
    exposed = np.clip(np.rint(texture() * gain + offset), 0, 255).astype(np.uint8)
    assert measure_sharpness(exposed) == pytest.approx(
        measure_sharpness(texture()), rel=0.03
    )  # rounding to grey levels


def test_a_blank_image_is_not_sharp_and_has_no_contrast():
    blank = np.full((120, 160, 3), 90, np.uint8)
    assert measure_sharpness(blank) == 0
    assert measure_contrast(blank) == 0
    assert measure_contrast(texture()) > 10
