"""Property and exact: radial distortion, its inverse and its limit."""

import numpy as np
import pytest

from threedfs.geometry.distortion import distort, turning_radius, undistort

LENSES = [(0.0, 0.0), (0.2, 0.0), (-0.3, 0.0), (-0.3, 0.1), (0.1, -0.05), (-0.05, 0.08), (0.0, 0.2), (0.0, -0.2)]


def grid():
    x, y = np.meshgrid(np.linspace(-0.7, 0.7, 29), np.linspace(-0.5, 0.5, 21))
    return np.stack([x, y], axis=-1)


@pytest.mark.parametrize("lens", LENSES)
def test_inverse_undoes_distortion(lens):
    points = grid()
    imaged = distort(points, lens)
    assert np.isfinite(imaged).all()  # |r| <= 0.86, before any of these lenses turns back
    # Newton's method ends at rounding error, amplified where the slope of the model is small.
    np.testing.assert_allclose(undistort(imaged, lens), points, atol=1e-11)


@pytest.mark.parametrize("lens", LENSES)
def test_distortion_undoes_inverse(lens):
    imaged = grid() * 0.5
    np.testing.assert_allclose(distort(undistort(imaged, lens), lens), imaged, atol=1e-12)


def test_value_by_hand():
    # r^2 = 0.25: 1 + 0.4 * 0.25 - 0.8 * 0.0625 = 1.05
    np.testing.assert_allclose(distort(np.array([0.3, 0.4]), (0.4, -0.8)), [0.315, 0.42], rtol=1e-15)


def test_beyond_the_turning_radius_there_is_nothing():
    lens = (-1 / 3, 0.0)
    assert turning_radius(lens) == pytest.approx(1.0)
    assert np.isnan(distort(np.array([1.01, 0.0]), lens)).all()
    # The largest imaged radius is 1 - 1/3.
    assert np.isnan(undistort(np.array([0.67, 0.0]), lens)).all()
    np.testing.assert_allclose(undistort(np.array([0.66, 0.0]), lens)[1], 0.0)
    assert np.isfinite(undistort(np.array([0.66, 0.0]), lens)).all()


@pytest.mark.parametrize(("lens", "radius"), [((0.1, 0.1), np.inf), ((-0.5, 0.2), np.inf), ((0.0, -0.2), 1.0)])
def test_turning_radius(lens, radius):
    # 1 - 1.5 s + s^2 has no real root; 1 - s^2 has the root 1.
    assert turning_radius(lens) == pytest.approx(radius)
