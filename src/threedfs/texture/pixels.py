"""Colours between the pixels of an image."""

from __future__ import annotations

import cv2
import numpy as np

_BLOCK = 30_000
"""Points at once: cv2.remap takes images of at most 32,767 rows."""


def sample_colors(image: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Return the colours (N, 3) float32 of an image (H, W, 3) float32 at pixels (u, v) (N, 2), interpolated.

    Beyond the image its border goes on.
    """
    colors = np.empty((len(pixels), 3), np.float32)
    for start in range(0, len(pixels), _BLOCK):
        places = pixels[start : start + _BLOCK, None].astype(np.float32)
        found = cv2.remap(image, places, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        colors[start : start + _BLOCK] = found[:, 0]
    return colors
