"""What is known of one keyframe's depth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.types import View


@dataclass(frozen=True)
class KeyframeDepth:
    """The depth of one keyframe, and what photographs and other views say of it.

    Attributes
    ----------
    view : View
    mask : (H, W) bool
        The object.
    length : float
        Of the object in the image, pixels.
    depth : (H, W) float32
        Scene units, NaN where missing.
    photometric : (H, W) float32
        Confidence by the keyframe's own photographs (3.2, Eq. 11).
    agree, too_far : (H, W) uint8
        See `Agreement`.
    confidence : (H, W) float32
        Share of agreement, in [0, 1] (`rate_confidence`).
    """

    view: View
    mask: np.ndarray
    length: float
    depth: np.ndarray
    photometric: np.ndarray
    agree: np.ndarray
    too_far: np.ndarray
    confidence: np.ndarray
