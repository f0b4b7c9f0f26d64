"""Intensity, its gradient, and the pixels that have enough of it."""

from __future__ import annotations

import cv2
import numpy as np


def to_grey(image: np.ndarray) -> np.ndarray:
    """Return the intensity (H, W) float32 in 0..255 of an image (H, W, 3) uint8 RGB."""
    return cv2.cvtColor(image.astype(np.float32), cv2.COLOR_RGB2GRAY)


def image_gradient(grey: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return central differences along u and v, each (H, W) float32, grey levels per pixel."""
    along_v, along_u = np.gradient(grey)
    return along_u.astype(np.float32), along_v.astype(np.float32)


def find_textured(grey: np.ndarray, valid: np.ndarray, min_gradient: float, margin: int) -> np.ndarray:
    """Find pixels whose largest gradient over 3x3 reaches a threshold, away from the border of the valid image.

    Parameters
    ----------
    grey : (H, W) float32
    valid : (H, W) bool
    min_gradient : float
        Grey levels per pixel.
    margin : int
        Pixels around, in both axes, that must be valid too: what the search reads around a pixel.

    Returns
    -------
    (H, W) bool
    """
    along_u, along_v = image_gradient(grey)
    strongest = cv2.dilate(np.hypot(along_u, along_v), np.ones((3, 3), np.uint8))
    reach = np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)
    interior = cv2.erode(valid.astype(np.uint8), reach, borderType=cv2.BORDER_CONSTANT, borderValue=0)
    return (strongest >= min_gradient) & (interior > 0)
