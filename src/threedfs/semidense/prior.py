"""What the sparse points say about the depth of every pixel before any search."""

from __future__ import annotations

import numpy as np
from numba import njit


def spread_sparse(
    pixels: np.ndarray,
    inverse_depth: np.ndarray,
    shape: tuple[int, int],
    bounds: tuple[float, float],
    radius: float,
    least_spread: float,
) -> tuple[np.ndarray, np.ndarray]:
    """Spread the inverse depth of sparse points over the pixels around them.

    Parameters
    ----------
    pixels : (P, 2) float64
        Where the points that the keyframe sees fall, (u, v).
    inverse_depth : (P,) float64
        1 / scene unit.
    shape : tuple
        (H, W) of the image.
    bounds : tuple of float
        Least and greatest inverse depth of the keyframe.
    radius : float
        Distance in pixels beyond which a point tells nothing.
    least_spread : float
        Standard deviation that is always added, over the mean inverse depth: between sparse points the surface may
        lie elsewhere.

    Returns
    -------
    mean, variance : (H, W) float64
        Weighted by distance; without a point in reach, two standard deviations on either side span the bounds.
    """
    kept = (inverse_depth > bounds[0]) & (inverse_depth < bounds[1])
    total, first, second = _accumulate(
        pixels[kept].astype(np.float64), inverse_depth[kept].astype(np.float64), shape[0], shape[1], radius
    )
    near_some = total > 0
    safe = np.where(near_some, total, 1)
    mean = np.where(near_some, first / safe, (bounds[0] + bounds[1]) / 2)
    spread = np.maximum(second / safe - mean**2, 0) + (least_spread * mean) ** 2
    widest = ((bounds[1] - bounds[0]) / 4) ** 2
    return mean, np.where(near_some, np.minimum(spread, widest), widest)


@njit(cache=True)
def _accumulate(pixels, inverse_depth, height, width, radius):
    total = np.zeros((height, width))
    first = np.zeros((height, width))
    second = np.zeros((height, width))
    for index in range(len(pixels)):
        u, v = pixels[index]
        value = inverse_depth[index]
        for row in range(max(int(np.ceil(v - radius)), 0), min(int(v + radius), height - 1) + 1):
            for column in range(max(int(np.ceil(u - radius)), 0), min(int(u + radius), width - 1) + 1):
                weight = 1 - ((row - v) ** 2 + (column - u) ** 2) / radius**2
                if weight > 0:
                    total[row, column] += weight
                    first[row, column] += weight * value
                    second[row, column] += weight * value * value
    return total, first, second
