"""Smoothing and outlier removal among neighbouring pixels (Engel, Sturm, Cremers 2013, Section 2.4)."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def regularise(mean, variance, consistency, smoothing, min_neighbourhood):
    """Average each estimate with those that agree with it in 5x5 pixels, and drop those that stand alone.

    Weights are 1 / (variance + (smoothing * r)^2), r the distance in pixels; estimates agree when
    (difference / consistency)^2 <= sum of both variances. An estimate goes when fewer than `min_neighbourhood`
    agree with it or more contradict it than agree.

    Parameters
    ----------
    mean, variance : (H, W) float64
        Inverse depth; NaN where there is none.
    consistency, smoothing : float
    min_neighbourhood : int

    Returns
    -------
    mean, variance : (H, W) float64
        The variance stays that of the pixel's own estimate: neighbouring errors are not independent.
    """
    height, width = mean.shape
    smooth = np.full((height, width), np.nan)
    kept = np.full((height, width), np.nan)
    for v in range(height):
        for u in range(width):
            if np.isnan(mean[v, u]):
                continue
            weight_sum = 1 / variance[v, u]
            weighted = mean[v, u] * weight_sum
            agree, contradict = 0, 0
            for row in range(max(v - 2, 0), min(v + 3, height)):
                for column in range(max(u - 2, 0), min(u + 3, width)):
                    if (row == v and column == u) or np.isnan(mean[row, column]):
                        continue
                    difference = mean[row, column] - mean[v, u]
                    if difference**2 > consistency**2 * (variance[v, u] + variance[row, column]):
                        contradict += 1
                        continue
                    agree += 1
                    distance2 = (row - v) ** 2 + (column - u) ** 2
                    weight = 1 / (variance[row, column] + smoothing**2 * distance2)
                    weight_sum += weight
                    weighted += weight * mean[row, column]
            if agree >= min_neighbourhood and agree >= contradict:
                smooth[v, u] = weighted / weight_sum
                kept[v, u] = variance[v, u]
    return smooth, kept
