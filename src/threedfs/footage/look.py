"""What single frames of a film tell: light, sharpness and texture."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from threedfs.frames.sharpness import measure_sharpness

_DARK, _BRIGHT = 24, 250  # grey levels
_FEATURES = 1000


@dataclass(frozen=True)
class Look:
    """One frame.

    Attributes
    ----------
    sharpness : float
        Mean squared spatial frequency, of an image of the size that frames are looked at in.
    level : float
        Median grey level.
    dark, clipped : float
        Shares of the pixels that are all but black, or white.
    pixels : (K, 2) float32
        Keypoints (u, v).
    descriptors : (K, 128) float32
    """

    sharpness: float
    level: float
    dark: float
    clipped: float
    pixels: np.ndarray
    descriptors: np.ndarray


def look_at_frame(image: np.ndarray) -> Look:
    """Measure an image (H, W, 3) uint8 RGB."""
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    keypoints, descriptors = cv2.SIFT_create(_FEATURES).detectAndCompute(grey, None)
    return Look(
        measure_sharpness(image),
        float(np.median(grey)),
        float((grey < _DARK).mean()),
        float((grey > _BRIGHT).mean()),
        np.array([point.pt for point in keypoints], np.float32).reshape(-1, 2),
        np.zeros((0, 128), np.float32) if descriptors is None else descriptors,
    )
