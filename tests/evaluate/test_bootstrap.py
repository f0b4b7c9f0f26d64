"""Exact, property and oracle (SciPy): confidence intervals of means."""

import numpy as np
import pytest
from scipy import stats

from threedfs.evaluate.bootstrap import mean_interval


def interval(values, seed=0, **options):
    return mean_interval(np.array(values), np.random.default_rng(seed), **options)


def test_two_values_have_their_own_interval():
    # a quarter of the samples is (a, a), a quarter (b, b): more than 2.5 % at either end
    assert interval([0.2, 0.6]) == (0.2, 0.6)
    assert interval([0.2, 0.6], level=0.4) == (0.4, 0.4)


def test_against_scipy():
    values = np.random.default_rng(5).normal(3, 1, 20)
    found = interval(values, level=0.9)
    expected = stats.bootstrap(
        (values,), np.mean, n_resamples=10000, confidence_level=0.9, method="percentile", rng=np.random.default_rng(1)
    ).confidence_interval
    # the quantile of 10,000 resamples has a standard deviation of about 0.02 of the mean's
    np.testing.assert_allclose(found, [expected.low, expected.high], atol=5 * 0.03 * values.std() / np.sqrt(20))


def test_of_many_values_it_is_the_normal_one():
    values = np.random.default_rng(6).normal(0, 2, 400)
    low, high = interval(values)
    half = 1.96 * values.std() / 20
    assert low == pytest.approx(values.mean() - half, abs=0.05 * half)
    assert high == pytest.approx(values.mean() + half, abs=0.05 * half)


def test_same_seed_same_interval_and_too_few_values_none():
    assert interval([1, 2, 4, 8]) == interval([1, 2, 4, 8])
    assert np.isnan(interval([0.5])).all() and np.isnan(interval([])).all()
