"""The paper's depth experiment: depths drawn from the ground truth, and errors by true depth (Section 4.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.evaluate.depth_error import DepthError, DepthPairs, measure_depth, pool_pairs
from threedfs.evaluate.figures import Figure

_OBJECT_PERCENTILES = (1.0, 99.0)


@dataclass(frozen=True)
class DepthBin:
    """Error over the pixels whose true depth is in [low, high): root mean square, and their number."""

    low: float
    high: float
    rmse: float
    pixels: int


def draw_measurements(truth: np.ndarray, count: int, generator: np.random.Generator) -> np.ndarray:
    """Draw pixels with a true depth at random, each at most once.

    The order is random too, so that the first n of them are a draw of n: what is measured with few is measured with
    many as well.

    Parameters
    ----------
    truth : (H, W) float
        NaN where unknown.
    count : int
    generator : numpy.random.Generator

    Returns
    -------
    (count, 2) int64, (row, column)

    Raises
    ------
    UserError
        If fewer pixels have a true depth.
    """
    known = np.argwhere(np.isfinite(truth))
    if len(known) < count:
        raise UserError(
            f"depth experiment: expected at least {count} pixels with a true depth to draw from, got {len(known)}; "
            "lower depth_trial.measurements, or check truth.depth."
        )
    return known[generator.permutation(len(known))[:count]]


def find_object_depths(truth: np.ndarray, on_object: np.ndarray) -> np.ndarray:
    """Find the pixels (H, W) whose true depth is one of the object's: from its 1st to its 99th percentile there.

    Percentiles, because at the object's border a true depth image may show what is behind it.

    Parameters
    ----------
    truth : (H, W) float
        NaN where unknown.
    on_object : (H, W) bool
    """
    depths = truth[on_object & np.isfinite(truth)]
    if len(depths) == 0:
        return np.zeros(truth.shape, bool)
    low, high = np.percentile(depths, _OBJECT_PERCENTILES)
    return (truth >= low) & (truth <= high)


def bin_errors(pairs: DepthPairs, width: float) -> list[DepthBin]:
    """Measure the root mean squared error as a function of true depth (the paper's plot).

    Parameters
    ----------
    pairs : DepthPairs
    width : float
        Of the intervals, which start at depth 0; those without a pixel are left out.
    """
    index = np.floor(pairs.truth / width).astype(np.int64)
    pixels = np.bincount(index)
    squares = np.bincount(index, (pairs.depth - pairs.truth) ** 2)
    return [
        DepthBin(
            round(number * width, 9),
            round((number + 1) * width, 9),
            float(np.sqrt(squares[number] / pixels[number])),
            int(count),
        )
        for number, count in enumerate(pixels)
        if count
    ]


def experiment_figures(
    everywhere: Mapping[str, DepthPairs], regions: Mapping[str, DepthPairs], bin_width: float, unit: str
) -> list[Figure]:
    """Return the figures of one method on one sequence.

    Parameters
    ----------
    everywhere : mapping of str to DepthPairs
        All pixels with a true depth, by keyframe.
    regions : mapping of str to DepthPairs
        Pixels of parts of the scene, of all keyframes together, by what the names of their figures begin with.
    bin_width : float
        Intervals of true depth for which the error is given too.
    unit : str
        Of the depths.
    """
    figures = [
        figure
        for name, pairs in everywhere.items()
        for figure in _error_figures(measure_depth(pairs), unit, "depth", name)
    ]
    for region, pairs in {"depth": pool_pairs(list(everywhere.values())), **regions}.items():
        error = measure_depth(pairs)
        figures += _error_figures(error, unit, region)
        if error is not None:
            figures.append(Figure(f"{region}_error_median", 100 * error.median, "%"))
        for part in bin_errors(pairs, bin_width):
            interval = f"bin_{part.low:g}_{part.high:g}"
            figures.append(Figure(f"{region}_rmse_{interval}", part.rmse, unit))
            figures.append(Figure(f"{region}_pixels_{interval}", part.pixels, "px"))
    return figures


def _error_figures(error: DepthError | None, unit: str, region: str, keyframe: str = "") -> list[Figure]:
    if error is None:
        return []
    return [
        Figure(f"{region}_rmse", error.rmse, unit, keyframe),
        Figure(f"{region}_error_mean", 100 * error.mean, "%", keyframe),
        Figure(f"{region}_within_1", 100 * error.within_1, "%", keyframe),
        Figure(f"{region}_within_10", 100 * error.within_10, "%", keyframe),
    ]
