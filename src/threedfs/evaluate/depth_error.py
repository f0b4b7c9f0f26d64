"""Error of depth maps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_erosion


@dataclass(frozen=True)
class DepthPairs:
    """Depths at pixels where both estimate and truth exist, in one unit.

    Attributes
    ----------
    depth, truth : (N,) float64
    missing : int
        Pixels with a true depth and no estimate.
    """

    depth: np.ndarray
    truth: np.ndarray
    missing: int = 0


@dataclass(frozen=True)
class DepthError:
    """Error over a set of pixels.

    Attributes
    ----------
    median, mean : float
        Of |depth - truth| / truth.
    within_1, within_10 : float
        Share of the pixels with a true depth whose relative error is at most 1 % and 10 %; a missing depth is not.
    rmse : float
        Root of the mean squared depth - truth, in the unit of the depths.
    covered : float
        Share of the pixels with a true depth that have an estimate.
    """

    median: float
    mean: float
    within_1: float
    within_10: float
    rmse: float
    covered: float


def pair_depths(depth: np.ndarray, truth: np.ndarray, erosion: int = 0) -> DepthPairs:
    """Pair the depths of two maps (H, W) of one unit, NaN where missing.

    Parameters
    ----------
    depth, truth : (H, W) float
    erosion : int
        Pixels taken off the border of where the truth is known: there one pixel sees two surfaces.
    """
    region = np.isfinite(truth)
    if erosion:
        region = binary_erosion(region, np.ones((3, 3), bool), iterations=erosion)
    estimate, exact = depth[region].astype(np.float64), truth[region].astype(np.float64)
    known = np.isfinite(estimate)
    return DepthPairs(estimate[known], exact[known], int(np.count_nonzero(~known)))


def pool_pairs(pairs: list[DepthPairs]) -> DepthPairs:
    """Put the pixels of several maps together."""
    return DepthPairs(
        np.concatenate([pair.depth for pair in pairs]),
        np.concatenate([pair.truth for pair in pairs]),
        sum(pair.missing for pair in pairs),
    )


def measure_depth(pairs: DepthPairs) -> DepthError | None:
    """Measure the error over pairs; None if there is no pixel.

    References
    ----------
    Section 4.2 measures the root mean squared error; the other figures are ours.
    """
    total = len(pairs.depth) + pairs.missing
    if len(pairs.depth) == 0:
        return None
    difference = pairs.depth - pairs.truth
    relative = np.abs(difference) / pairs.truth
    return DepthError(
        median=float(np.median(relative)),
        mean=float(relative.mean()),
        within_1=int(np.count_nonzero(relative <= 0.01)) / total,
        within_10=int(np.count_nonzero(relative <= 0.1)) / total,
        rmse=float(np.sqrt((difference**2).mean())),
        covered=len(pairs.depth) / total,
    )
