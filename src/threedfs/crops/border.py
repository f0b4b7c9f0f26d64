"""Whether a crop cuts the object off."""

from __future__ import annotations

import numpy as np

from threedfs.types import Camera

_WITHIN = 1.0
"""Pixels of the whole frame from its side up to which a crop's side is the frame's own."""


def is_cut_off(mask: np.ndarray, camera: Camera, whole: Camera) -> bool:
    """Say whether a mask (H, W) bool reaches a side of its crop that is not a side of the whole frame.

    Parameters
    ----------
    mask : (H, W) bool
    camera : Camera
        Of the crop.
    whole : Camera
        Of the whole undistorted frame, at any resolution.
    """
    scale = whole.fx / camera.fx
    left, top = whole.cx - scale * (camera.cx + 0.5), whole.cy - scale * (camera.cy + 0.5)
    right, bottom = left + scale * camera.width, top + scale * camera.height
    sides = (
        (mask[:, 0], left + 0.5),
        (mask[0], top + 0.5),
        (mask[:, -1], whole.width - 0.5 - right),
        (mask[-1], whole.height - 0.5 - bottom),
    )
    return any(bool(touched.any()) and inward > _WITHIN for touched, inward in sides)
