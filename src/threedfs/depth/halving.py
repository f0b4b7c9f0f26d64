"""The depth problem on every other pixel: what is known about a keyframe, and a surface taken back to all pixels."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit


@dataclass(frozen=True)
class DepthData:
    """What the depth of a keyframe is found from; see `optimise_depth` for each array."""

    cost_volume: np.ndarray
    confidence: np.ndarray
    measured_depth: np.ndarray
    measurement_weight: np.ndarray
    edge_weight: np.ndarray


def halve_data(data: DepthData) -> DepthData:
    """Put each 2x2 pixels into one; a last odd row or column is counted twice.

    Costs, confidences and weights are averaged, measured depths by their weight. Of edges the strongest counts, so
    that it cuts the coarse surface too.
    """
    weight = _halve(data.measurement_weight)
    weighed = np.where(data.measurement_weight > 0, data.measurement_weight * data.measured_depth, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = np.where(weight > 0, _halve(weighed) / weight, np.nan)
    return DepthData(
        _halve_volume(data.cost_volume),
        _halve(data.confidence),
        measured,
        weight,
        np.min(_quarters(data.edge_weight), axis=0),
    )


def double_depth(depth: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Interpolate the depth of halved data bilinearly at the pixels (H, W) that it was made of, float64."""
    height, width = depth.shape
    return cv2.resize(depth, (2 * width, 2 * height), interpolation=cv2.INTER_LINEAR)[: shape[0], : shape[1]]


def _quarters(image: np.ndarray) -> list[np.ndarray]:
    height, width = image.shape
    even = np.pad(image, ((0, height % 2), (0, width % 2)), mode="edge")
    return [even[row::2, column::2] for row in (0, 1) for column in (0, 1)]


def _halve(image: np.ndarray) -> np.ndarray:
    return np.mean(_quarters(image), axis=0)


@njit(cache=True)
def _halve_volume(volume):
    count, height, width = volume.shape
    half = np.empty((count, (height + 1) // 2, (width + 1) // 2), volume.dtype)
    quarter = np.float32(0.25)
    for i in range(count):
        for v in range(half.shape[1]):
            above, below = volume[i, 2 * v], volume[i, min(2 * v + 1, height - 1)]
            row = half[i, v]
            for u in range(width // 2):
                row[u] = quarter * (above[2 * u] + above[2 * u + 1] + (below[2 * u] + below[2 * u + 1]))
            if width % 2:
                row[width // 2] = quarter * 2 * (above[width - 1] + below[width - 1])
    return half
