"""The depths to expect in a keyframe."""

from __future__ import annotations

import numpy as np

from threedfs.errors import UserError

LEAST_POINTS = 10
"""Sparse points in view below which nothing can be said of a keyframe's depth."""


def expect_depth_range(depths: np.ndarray, near_factor: float, far_factor: float, what: str) -> tuple[float, float]:
    """Widen the range of the sparse depths in view, so that what no sparse point shows is inside too.

    Parameters
    ----------
    depths : (P,) float64
        Depths of the sparse points that fall on the image, scene units; NaN for the others.
    near_factor, far_factor : float
        Near end over the 1st percentile, far end over the 97th: the foreground often carries no points, and the
        last percents are badly triangulated ones.
    what : str
        Name of the keyframe in the message.

    Returns
    -------
    near, far : float
        Scene units.

    Raises
    ------
    UserError
        If fewer than `LEAST_POINTS` points are in view.
    """
    depths = depths[np.isfinite(depths)]
    if len(depths) < LEAST_POINTS:
        raise UserError(
            f"keyframe {what}: expected at least {LEAST_POINTS} sparse points in view, got {len(depths)}; "
            "its camera looks past the scene or its pose is wrong, so remove the frame or check the given cameras."
        )
    low, high = np.percentile(depths, (1, 97))
    return float(near_factor * low), float(far_factor * high)
