"""Which stereo matches are believed."""

from __future__ import annotations

import numpy as np


def confirm_matches(
    inverse_depth: np.ndarray,
    slope: np.ndarray,
    cost: np.ndarray,
    agreeing: np.ndarray,
    *,
    max_cost: float,
    min_agreeing: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Keep the matches that look alike and that other views confirm.

    Parameters
    ----------
    inverse_depth, cost : (H, W) float
        1 / scene unit; (1 - NCC) / 2.
    slope : (H, W, 2) float, 1 / (scene unit px)
    agreeing : (H, W) int
        Views whose matches lie at the same place.
    max_cost : float
    min_agreeing : int

    Returns
    -------
    inverse_depth, slope
        NaN where a match is dropped.
    """
    kept = (cost <= max_cost) & (agreeing >= min_agreeing)
    return np.where(kept, inverse_depth, np.nan), np.where(kept[..., None], slope, np.nan)
