"""The measurements that a keyframe's depth is fitted to: semi-dense depth and stereo matches together."""

from __future__ import annotations

import numpy as np


def merge_measurements(
    semidense: np.ndarray, variance: np.ndarray, stereo: np.ndarray, deviation: float
) -> tuple[np.ndarray, np.ndarray]:
    """Merge two maps of inverse depth by their variances.

    Parameters
    ----------
    semidense, variance : (H, W) float64
        Inverse depth and its variance; NaN where there is none.
    stereo : (H, W) float64
        Inverse depth of the stereo matches; NaN where there is none.
    deviation : float
        Standard deviation of a stereo match, relative to its inverse depth.

    Returns
    -------
    inverse_depth, variance : (H, W) float64
        NaN where neither map has a value.
    """
    maps = np.stack([semidense, stereo])
    precision = np.nan_to_num(1 / np.stack([variance, (deviation * stereo) ** 2]))
    total = precision.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (precision * np.nan_to_num(maps)).sum(axis=0) / total, np.where(total > 0, 1 / total, np.nan)


def distrust_unmatched(confidence: np.ndarray, stereo: np.ndarray, trust: float) -> np.ndarray:
    """Lower the confidence (H, W) in the photometric error to a share where stereo (H, W) found no match (NaN).

    Beyond the paper: where slanted patches match nowhere, patches parallel to the image match by chance.
    """
    return np.where(np.isnan(stereo), trust * confidence, confidence)
