"""Prior, pixel choice, fusion and regularisation, each by itself."""

from __future__ import annotations

import numpy as np

from threedfs.semidense.gradient import find_textured, image_gradient, to_grey
from threedfs.semidense.prior import spread_sparse
from threedfs.semidense.regularise import regularise


def spread(pixels, inverse_depth, radius=5.0):
    return spread_sparse(np.array(pixels, float), np.array(inverse_depth, float), (20, 30), (0.2, 2.2), radius, 0.1)


def test_prior_is_the_point_near_it_and_the_range_elsewhere():
    """Exact: one point rules its radius with the least spread; beyond it two deviations reach both ends."""
    mean, variance = spread([(10, 8)], [1.5])
    np.testing.assert_allclose((mean[8, 10], mean[8, 14], mean[8, 16]), (1.5, 1.5, 1.2), rtol=1e-12)
    np.testing.assert_allclose(variance[8, 10], 0.15**2, rtol=1e-12)
    np.testing.assert_allclose(mean[8, 16] + 2 * np.sqrt(variance[8, 16]) * np.array([-1, 1]), (0.2, 2.2))


def test_prior_widens_between_points_at_different_depths():
    """Exact: half way between points at 1 and 1.4 the mean is 1.2 and the variance 0.2^2 more."""
    mean, variance = spread([(10, 8), (14, 8)], [1.0, 1.4])
    np.testing.assert_allclose(mean[8, 12], 1.2, rtol=1e-12)
    np.testing.assert_allclose(variance[8, 12], 0.2**2 + 0.12**2, rtol=1e-9)


def test_points_outside_the_range_tell_nothing():
    """Exact: a point farther than the far end is not spread."""
    np.testing.assert_allclose(spread([(10, 8)], [0.1])[0], 1.2, rtol=1e-12)


def test_grey_and_gradient_have_known_values():
    """Exact: a grey ramp of 3 levels a column has gradient (3, 0)."""
    ramp = np.repeat((3 * np.arange(40, dtype=np.uint8))[None, :, None], 20, axis=0).repeat(3, axis=2)
    along_u, along_v = image_gradient(to_grey(ramp))
    # The weights of the channels sum to 1 in float32.
    np.testing.assert_allclose(along_u, 3, atol=1e-4)
    np.testing.assert_allclose(along_v, 0, atol=1e-4)


def test_textured_pixels_lie_at_gradients_inside_the_valid_image():
    """Exact: a step of 100 levels marks its 4 columns, but for 3 pixels along the border and invalid pixels."""
    grey = np.zeros((20, 30), np.float32)
    grey[:, 15:] = 100
    valid = np.ones((20, 30), bool)
    valid[:5] = False
    expected = np.zeros((20, 30), bool)
    expected[8:17, 13:17] = True
    np.testing.assert_array_equal(find_textured(grey, valid, 5.0, margin=3), expected)


def test_agreeing_estimates_are_averaged_by_weight():
    """Exact: two pixels side by side, weights 1 / variance and 1 / (variance + smoothing^2)."""
    mean, variance = np.full((9, 9), np.nan), np.full((9, 9), np.nan)
    mean[4, 4], mean[4, 5] = 1.0, 1.1
    variance[4, 4], variance[4, 5] = 0.01, 0.02
    smooth, kept = regularise(mean, variance, 2.0, 0.1, 1)
    expected = (1.0 / 0.01 + 1.1 / (0.02 + 0.01)) / (1 / 0.01 + 1 / (0.02 + 0.01))
    np.testing.assert_allclose(smooth[4, 4], expected, rtol=1e-12)
    assert kept[4, 4] == 0.01
    assert np.isfinite(smooth).sum() == 2


def test_outliers_and_loners_go():
    """Exact: a pixel contradicted by its surroundings and one without any are removed; the surroundings stay."""
    mean, variance = np.full((12, 12), np.nan), np.full((12, 12), np.nan)
    mean[2:7, 2:7], variance[2:7, 2:7] = 1.0, 1e-4
    mean[4, 4] = 2.0
    mean[10, 10], variance[10, 10] = 1.0, 1e-4
    smooth, _ = regularise(mean, variance, 2.0, 0.075, 2)
    assert np.isnan(smooth[4, 4]) and np.isnan(smooth[10, 10])
    np.testing.assert_array_equal(np.isfinite(smooth).sum(), 24)
    np.testing.assert_allclose(smooth[np.isfinite(smooth)], 1.0, rtol=1e-12)


def test_depth_edges_are_not_smoothed():
    """Exact: two flat halves at different depths keep their values."""
    mean, variance = np.full((8, 12), 1.0), np.full((8, 12), 1e-4)
    mean[:, 6:] = 2.0
    smooth, _ = regularise(mean, variance, 2.0, 0.075, 2)
    # Averages of equal numbers round at 1e-16.
    np.testing.assert_allclose(smooth, mean, rtol=1e-12)
