"""Density of a mixture of colours: oracle and bounds."""

import numpy as np
import pytest
from sklearn.mixture import GaussianMixture

from threedfs.segment.mixture import Mixture, log_density


@pytest.fixture(scope="module")
def fitted():
    rng = np.random.default_rng(1)
    colors = np.concatenate([rng.normal(middle, 4.0, (300, 3)) for middle in ([20, 0, 5], [60, -10, 30], [80, 5, -5])])
    return GaussianMixture(3, random_state=0).fit(colors)


@pytest.fixture(scope="module")
def mixture(fitted):
    return Mixture(fitted.weights_, fitted.means_, fitted.precisions_cholesky_)


def test_density_is_that_of_the_library(mixture, fitted):
    lab = np.random.default_rng(2).uniform([0, -60, -60], [100, 60, 60], (2000, 3)).astype(np.float32)
    np.testing.assert_allclose(log_density(mixture, lab), fitted.score_samples(lab), rtol=1e-6, atol=1e-6)


def test_far_colors_have_a_finite_density(mixture, fitted):
    far = np.array([[1e3, 1e3, 1e3]], np.float32)
    assert np.isfinite(log_density(mixture, far)).all()
    np.testing.assert_allclose(log_density(mixture, far), fitted.score_samples(far), rtol=1e-6)


def test_no_color_has_no_density(mixture):
    assert log_density(mixture, np.zeros((0, 3), np.float32)).shape == (0,)
