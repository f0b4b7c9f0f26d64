"""The depths to expect in a crop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from threedfs.geometry.projection import inside, project
from threedfs.types import Keyframe

_LEAST_NEAR = 0.05
"""Near end over the depth of the box's middle, where the box reaches the camera."""


def expect_crop_range(
    keyframe: Keyframe,
    points: np.ndarray,
    corners: np.ndarray,
    near_factor: float,
    far_factor: float,
    frame_far_factor: float,
) -> Keyframe:
    """Give a keyframe the depths to search in its crop, scene units: the box, and what sparse points show behind it.

    Parameters
    ----------
    keyframe : Keyframe
        Its view is that of the crop; its range is that of the whole frame, which limits the far end unless the box
        reaches farther.
    points : (P, 3) float64
        Sparse points, world.
    corners : (8, 3) float64
        Of the object's box, world.
    near_factor, far_factor : float
        Near end over the box's nearest depth, far end over the 97th percentile of the points' depths.
    frame_far_factor : float
        Far end of the whole frame's range over that percentile of the points in the frame.

    Returns
    -------
    Keyframe
        With the crop's range, and the box's nearest (at least the near end) and farthest depth as `within`.
    """
    view = keyframe.view
    depths = project(view, corners)[1]
    near = max(near_factor * depths.min(), _LEAST_NEAR * depths.mean())
    pixels, depth = project(view, points)
    shown = depth[inside(view.camera, pixels)]
    behind = min(np.percentile(shown, 97), keyframe.far / frame_far_factor) if len(shown) else 0.0
    nearest, farthest = max(depths.min(), near), depths.max()
    far = far_factor * max(behind, farthest)
    return replace(keyframe, near=float(near), far=float(far), within=(float(nearest), float(farthest)))
