"""How sure a mean over sequences is."""

from __future__ import annotations

import numpy as np

_RESAMPLES = 10_000


def mean_interval(values: np.ndarray, generator: np.random.Generator, level: float = 0.95) -> tuple[float, float]:
    """Return the ends of a confidence interval of the mean, by bootstrap over the values.

    The percentile interval: the middle part, of size `level`, of the means of 10,000 samples drawn with replacement.
    With few values it is too narrow: of five normal ones it holds the mean in 84 % of cases, not in 95 %.

    Parameters
    ----------
    values : (N,) float
    generator : numpy.random.Generator
    level : float
        In (0, 1).

    Returns
    -------
    low, high : float
        NaN for fewer than two values.

    References
    ----------
    Efron, Bootstrap methods: another look at the jackknife, 1979.

    Examples
    --------
    >>> mean_interval(np.array([0.5, 0.5, 0.5]), np.random.default_rng(0))
    (0.5, 0.5)
    """
    values = np.asarray(values, np.float64)
    if len(values) < 2:
        return float("nan"), float("nan")
    drawn = values[generator.integers(len(values), size=(_RESAMPLES, len(values)))].mean(axis=1)
    low, high = np.quantile(drawn, [(1 - level) / 2, (1 + level) / 2])
    return float(low), float(high)
