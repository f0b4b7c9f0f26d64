"""The colour of a point of the mesh, from all photographs that show it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from threedfs.geometry.projection import project
from threedfs.texture.pixels import sample_colors
from threedfs.texture.vertices import Reader
from threedfs.types import View


def blend_photographs(
    points: np.ndarray, part: np.ndarray, areas: np.ndarray, views: Sequence[View], read_image: Reader
) -> np.ndarray:
    """Return the colour (N, 3) uint8 of points: in each channel the weighted median of the views that show it.

    A median, as a highlight, or a thing in between, is in few. A view's weight is the area at which it shows the
    part of the mesh. Of two values in the middle the lower one counts.

    Parameters
    ----------
    points : (N, 3) float64
        World.
    part : (N,) int64
        Of the mesh that each point lies on, a row of `areas`; one view at least must show it.
    areas : (P, views) float32
        In which each view shows each part; 0 where it does not.
    views : sequence of View
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a view by its name.
    """
    weights = areas[part]
    samples = np.zeros((*weights.shape, 3), np.uint8)
    for rank, view in enumerate(views):
        shown = np.flatnonzero(weights[:, rank] > 0)
        if len(shown):
            image = read_image(view.name).astype(np.float32)
            samples[shown, rank] = np.rint(sample_colors(image, project(view, points[shown])[0]))
    return _weighted_median(samples, weights)


@njit(cache=True)
def _weighted_median(samples, weights):
    """Return the median (N, C) of samples (N, views, C), of which each has a weight (N, views): by a histogram."""
    count, views, channels = samples.shape
    middle = np.zeros((count, channels), np.uint8)
    weight_of = np.zeros(256)
    for n in range(count):
        total = 0.0
        for view in range(views):
            total += weights[n, view]
        for channel in range(channels):
            low, high = 255, 0
            for view in range(views):
                if weights[n, view] > 0:
                    level = int(samples[n, view, channel])
                    weight_of[level] += weights[n, view]
                    low, high = min(low, level), max(high, level)
            below = 0.0
            found = False
            for level in range(low, high + 1):
                below += weight_of[level]
                weight_of[level] = 0.0
                if not found and below >= total / 2:
                    middle[n, channel] = level
                    found = True
    return middle
