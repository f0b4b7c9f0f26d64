"""Step 1: point-wise search over the depth candidates (Section 3.2, Eqs. 5-7)."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit


def search_depth(
    cost_volume: np.ndarray,
    candidates: np.ndarray,
    depth: np.ndarray,
    *,
    photometric_weight: float,
    coupling: float,
    median_size: int,
    newton_rate: float,
) -> np.ndarray:
    """Find the auxiliary depth: argmin over candidates, median filter, one Newton step (Eqs. 5-7).

    Parameters
    ----------
    cost_volume : (D, H, W) float32
    candidates : (D,) float64, ascending
    depth : (H, W) float64
        The smooth depth of the previous iteration.
    photometric_weight : float
        lambda_c.
    coupling : float
        theta; the auxiliary energy is lambda_c C + (d - depth)^2 / (2 theta).
    median_size : {1, 3, 5}
        Side of the median filter; 1 is none.
    newton_rate : float
        Learning rate of the Newton step; 0 is none.

    Returns
    -------
    (H, W) float64

    Notes
    -----
    Differs from the paper: the Newton step never leaves the interval to the next candidates, where the parabola
    through three samples of the energy says something, and is left out where that is not convex.
    """
    pull = 1 / (2 * coupling)
    best = _search(cost_volume, candidates, depth, photometric_weight, pull)
    auxiliary = best.astype(np.float32)
    if median_size > 1:
        auxiliary = cv2.medianBlur(auxiliary, median_size)
    auxiliary = auxiliary.astype(np.float64)
    if newton_rate > 0:
        _newton_step(cost_volume, candidates, depth, auxiliary, photometric_weight, pull, newton_rate)
    return auxiliary


def cheapest_depth(cost_volume: np.ndarray, candidates: np.ndarray) -> np.ndarray:
    """Return the candidate (D,) of least cost (D, H, W) in each pixel, (H, W) float64; the nearer one of equals."""
    return _search(cost_volume, candidates, np.zeros(cost_volume.shape[1:]), 1.0, 0.0)


@njit(cache=True)
def _search(cost_volume, candidates, depth, photometric_weight, pull):
    count, height, width = cost_volume.shape
    best = np.empty((height, width))
    weight = np.float32(photometric_weight)
    least = np.empty(width, np.float32)
    winner = np.empty(width, np.float32)
    for v in range(height):
        least[:] = np.float32(np.inf)
        for i in range(count):
            row = cost_volume[i, v]
            candidate = np.float32(candidates[i])
            for u in range(width):
                away = candidate - np.float32(depth[v, u])
                energy = weight * row[u] + np.float32(pull) * away * away
                better = energy < least[u]
                least[u] = energy if better else least[u]
                winner[u] = candidate if better else winner[u]
        for u in range(width):
            best[v, u] = winner[u]
    return best


@njit(cache=True)
def _newton_step(cost_volume, candidates, depth, auxiliary, photometric_weight, pull, rate):
    count, height, width = cost_volume.shape
    for v in range(height):
        for u in range(width):
            value = auxiliary[v, u]
            i = min(max(np.searchsorted(candidates, value), 1), count - 2)
            if candidates[i] - value > value - candidates[i - 1]:
                i = max(i - 1, 1)
            d0, d1, d2 = candidates[i - 1], candidates[i], candidates[i + 1]
            e0 = photometric_weight * cost_volume[i - 1, v, u] + pull * (d0 - depth[v, u]) ** 2
            e1 = photometric_weight * cost_volume[i, v, u] + pull * (d1 - depth[v, u]) ** 2
            e2 = photometric_weight * cost_volume[i + 1, v, u] + pull * (d2 - depth[v, u]) ** 2
            slope_left = (e1 - e0) / (d1 - d0)
            slope_right = (e2 - e1) / (d2 - d1)
            curvature = 2 * (slope_right - slope_left) / (d2 - d0)
            if curvature <= 0:
                continue
            gradient = slope_left + curvature * (value - (d0 + d1) / 2)
            auxiliary[v, u] = min(max(value - rate * gradient / curvature, d0), d2)
