"""Images smoothed over some pixels."""

from __future__ import annotations

import cv2
import numpy as np

_ENDS = 4.0
"""Standard deviations from its middle at which the Gaussian is cut off."""


def blur(image: np.ndarray, deviation: float) -> np.ndarray:
    """Return an image (H, W), float32 or float64, convolved with a Gaussian, as if mirrored at its borders.

    Parameters
    ----------
    image : (H, W) float32 or float64
        The result has its type; float32 takes a third of the time.
    deviation : float
        Standard deviation, pixels.
    """
    side = 2 * round(_ENDS * deviation) + 1
    return cv2.GaussianBlur(image, (side, side), deviation, borderType=cv2.BORDER_REFLECT)
