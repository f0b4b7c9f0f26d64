"""Contour strength on images whose contours are known."""

from __future__ import annotations

import numpy as np
import pytest

from threedfs.edges.multiscale import multiscale_gradient


def strength_of(image, valid=None, full_strength_percentile=98.0, min_full_strength=2.0):
    valid = np.ones(image.shape[:2], bool) if valid is None else valid
    return multiscale_gradient(image, valid, (1.0, 2.0, 4.0), full_strength_percentile, min_full_strength)


def halves(left, right, height=60, width=80):
    image = np.empty((height, width, 3), np.uint8)
    image[:, : width // 2], image[:, width // 2 :] = left, right
    return image


def test_strength_is_one_on_the_contour_and_thin():
    """Exact: a step between two colours is the only contour, at most 7 pixels wide at half strength."""
    strength = strength_of(halves((200, 30, 30), (30, 30, 200)), full_strength_percentile=96.0)
    assert strength.dtype == np.float32
    assert np.all(strength[:, 39:41] == 1)
    # The finest of three scales blurs by 1 px, the coarsest by 4: their geometric mean stays within +-3 px.
    assert np.all(strength[:, :36] < 0.5) and np.all(strength[:, 44:] < 0.5)
    assert np.all(strength[:, :24] < 0.01)


def test_equal_brightness_is_still_a_contour():
    """Property: two colours of the same grey level differ in Lab."""
    grey_of_red = round(0.299 * 200)
    strength = strength_of(halves((200, 0, 0), (grey_of_red,) * 3))
    assert strength[:, 39:41].min() > 0.9


def test_border_of_the_valid_image_is_no_contour():
    """Property: the black left by undistortion casts no edge, on either side of its border."""
    image = np.full((60, 80, 3), 180, np.uint8)
    valid = np.zeros((60, 80), bool)
    valid[8:-8, 10:-10] = True
    image[~valid] = 0
    # A constant image smoothed with weights is constant but for float32 rounding of Lab values near 70.
    assert strength_of(image, valid).max() < 1e-3


def test_content_outside_the_valid_image_does_not_matter():
    """Property: what lies outside the valid image leaves the strength inside unchanged."""
    image = halves((200, 30, 30), (30, 30, 200))
    valid = np.ones(image.shape[:2], bool)
    valid[:12] = False
    other = image.copy()
    other[:12] = 255
    np.testing.assert_array_equal(strength_of(image, valid), strength_of(other, valid))


@pytest.mark.parametrize("level", [0, 128, 255])
def test_noise_in_a_blank_image_is_no_contour(level):
    """Property: sensor noise of 3 grey levels reaches a fraction of full strength only."""
    noise = np.random.default_rng(0).normal(0, 3, (60, 80, 3))
    image = np.clip(level + noise, 0, 255).astype(np.uint8)
    strength = strength_of(image)
    assert np.isfinite(strength).all()
    # Its Lab gradient is about 0.3 to 1.3 units per pixel after smoothing; full strength is at least 2.
    assert strength.mean() < 0.25


def test_contour_outshines_texture():
    """Property: fine texture of the same contrast as a contour is weaker than it."""
    image = halves((60, 60, 60), (160, 160, 160))
    image[::2, :32:2] += 50
    image[1::2, 1:32:2] += 50
    strength = strength_of(image)
    assert strength[:, 39:41].mean() > 2 * strength[10:50, 6:26].mean()


def test_an_invalid_image_has_no_strength():
    """Exact: without valid pixels all is 0."""
    assert not strength_of(np.full((20, 20, 3), 90, np.uint8), np.zeros((20, 20), bool)).any()
