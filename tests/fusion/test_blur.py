"""Smoothing of images."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from threedfs.blur import blur


@pytest.mark.parametrize("deviation", [0.4, 1.0, 2.3, 11.0])
@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-14), (np.float32, 1e-6)])
def test_agrees_with_another_gaussian(deviation, dtype, tolerance):
    """At 11 pixels the Gaussian is wider than the image, and its borders are mirrored more than once."""
    image = np.random.default_rng(1).random((31, 40)).astype(dtype)
    smooth = blur(image, deviation)
    assert smooth.dtype == dtype
    assert np.abs(smooth - gaussian_filter(image.astype(np.float64), deviation)).max() < tolerance


def test_no_deviation_changes_nothing():
    image = np.random.default_rng(2).random((5, 6))
    assert np.array_equal(blur(image, 0.0), image)
