"""The depths to expect in a crop."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.projection import inside, project
from threedfs.types import View

_LEAST_NEAR = 0.05
"""Near end over the depth of the box's middle, where the box reaches the camera."""


def expect_crop_range(
    view: View,
    points: np.ndarray,
    corners: np.ndarray,
    whole: tuple[float, float],
    near_factor: float,
    far_factor: float,
) -> tuple[float, float]:
    """Return the nearest and farthest depth to search, scene units: the box, and what sparse points show behind it.

    Parameters
    ----------
    view : View
        Of the crop.
    points : (P, 3) float64
        Sparse points, world.
    corners : (8, 3) float64
        Of the object's box, world.
    whole : tuple of float
        Near and far end for the whole frame; the crop's far end is at most that, or the box's.
    near_factor, far_factor : float
        Near end over the box's nearest depth, far end over the 97th percentile of the points' depths.
    """
    depths = project(view, corners)[1]
    near = max(near_factor * depths.min(), _LEAST_NEAR * depths.mean())
    pixels, depth = project(view, points)
    shown = depth[inside(view.camera, pixels)]
    behind = min(np.percentile(shown, 97), whole[1] / far_factor) if len(shown) else 0.0
    return float(near), float(far_factor * max(behind, depths.max()))
