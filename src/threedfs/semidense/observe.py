"""Kalman fusion of what is found along epipolar lines (Engel, Sturm, Cremers 2013, Section 2.3)."""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.semidense.epipolar import FOUND, NOT_FOUND, WORK, search_line

_INFLATION = 1.5
"""Factor on the variance of an estimate that an observation contradicts."""


@njit(cache=True)
def observe_neighbour(
    grey, gradient_u, gradient_v, searched, other, other_valid, geometry, rule, bounds, consistency, state
):
    """Search every pixel in one neighbour and update the estimates by Kalman's rule.

    An observation agrees when (difference / consistency)^2 <= sum of both variances; then means are weighted by
    inverse variance. Otherwise the variance is inflated and the observation counts against the estimate.

    Parameters
    ----------
    grey, gradient_u, gradient_v : (H, W) float32
    searched : (H, W) bool
        Pixels to search.
    other, other_valid : (H2, W2) float32, bool
    geometry : PairGeometry
    rule : SearchRule
    bounds : tuple of float
        Least and greatest inverse depth.
    consistency : float
    state : (4, H, W) float64
        Mean and variance of inverse depth, agreeing and contradicting neighbours; changed in place.
    """
    height, width = grey.shape
    known = np.where(other_valid, other, np.float32(np.nan))
    work = np.empty((2, WORK))
    for v in range(height):
        for u in range(width):
            if not searched[v, u]:
                continue
            mean, variance = state[0, v, u], state[1, v, u]
            reach = 2 * np.sqrt(variance)
            low, high = max(mean - reach, bounds[0]), min(mean + reach, bounds[1])
            outcome, observed, uncertainty = search_line(
                grey, gradient_u, gradient_v, known, u, v, low, high, bounds, geometry, rule, work
            )
            if outcome == NOT_FOUND:
                state[3, v, u] += 1
            elif outcome == FOUND:
                total = variance + uncertainty
                if (observed - mean) ** 2 > consistency**2 * total:
                    state[1, v, u] = variance * _INFLATION
                    state[3, v, u] += 1
                else:
                    state[0, v, u] = (uncertainty * mean + variance * observed) / total
                    state[1, v, u] = variance * uncertainty / total
                    state[2, v, u] += 1
