"""Contour strength by colour gradients at several scales."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np


def multiscale_gradient(
    image: np.ndarray,
    valid: np.ndarray,
    scales: Sequence[float],
    full_strength_percentile: float,
    min_full_strength: float,
) -> np.ndarray:
    """Measure contour strength: the geometric mean of the Lab gradient at several scales.

    At every scale the gradient is the largest singular value of the colour Jacobian. The mean is large only where all
    scales are: the coarse ones fade texture and noise, the fine ones keep the contour thin.

    Differs from the paper: it uses the Structured Edge Detector (Section 3.2, item ii, Eq. 9); this needs no training.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    valid : (H, W) bool
        Pixels that show the scene; elsewhere, and at its border, the strength is 0.
    scales : sequence of float
        Standard deviations of the Gaussian smoothing, pixels.
    full_strength_percentile : float
        Percentile of the combined gradient over the valid image that becomes 1.
    min_full_strength : float
        Lab units per pixel that become 1 at least.

    Returns
    -------
    (H, W) float32
        In [0, 1].
    """
    lab = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_RGB2Lab)
    inside = valid.astype(np.float32)
    combined = np.ones(valid.shape, np.float64)
    for scale in scales:
        combined *= _gradient_at(lab, inside, scale)
    combined **= 1 / len(scales)
    combined = np.where(valid, combined, 0)
    full = max(
        float(np.percentile(combined[valid], full_strength_percentile)) if valid.any() else 0,
        min_full_strength,
    )
    return np.clip(combined / full, 0, 1).astype(np.float32)


def _gradient_at(lab, inside, scale):
    """Gradient magnitude (H, W) of the image smoothed by `scale`, without the step at the border of `inside`."""
    # Normalised smoothing: pixels outside weigh nothing, so the border casts no edge.
    weight = _smooth(inside, scale)
    smooth = _smooth(lab * inside[..., None], scale) / np.maximum(weight, 1e-6)[..., None]
    along_u, along_v = np.gradient(smooth, axis=1), np.gradient(smooth, axis=0)
    uu, vv, uv = (along_u**2).sum(-1), (along_v**2).sum(-1), (along_u * along_v).sum(-1)
    largest = (uu + vv + np.sqrt((uu - vv) ** 2 + 4 * uv**2)) / 2
    interior = cv2.erode(inside, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT, borderValue=1)
    return np.sqrt(largest) * (interior > 0)


def _smooth(channel, scale):
    return cv2.GaussianBlur(channel, (0, 0), scale, borderType=cv2.BORDER_REPLICATE)
