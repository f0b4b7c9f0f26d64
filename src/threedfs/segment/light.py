"""How the light of one image differs from that of the support surface's picture: exposure, white balance, gloss."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.ndimage import gaussian_filter

_LEAST_PIXELS = 100
"""Pixels that show the support surface bare, without which nothing is known of an image's light."""
_UNLIKE = 20.0
"""Distance in Lab from what is expected at which a block of pixels counts half: a thing that was moved, say."""
_ROUNDS = 2
"""Times that the light is estimated, each by blocks that were like the estimate before."""
_FEW = 0.005
"""Share of such pixels around a place below which the light is that of the whole image rather."""
_STEPS = 4.0
"""Blocks in `reach`."""


def relight_table(lab: np.ndarray, color: np.ndarray, bare: np.ndarray, reach: float) -> np.ndarray:
    """Return the support surface's colours as the light of one image shows them, (H, W, 3) float32.

    Not in the paper. The picture of the support surface is the median of all views, but a camera changes its exposure,
    and polished stone or wood shines from one side. So what an image has beside the picture where it shows the bare
    surface, on the mean of a neighbourhood, is added to it, there and where the object may hide it.

    Parameters
    ----------
    lab, color : (H, W, 3) float32
        The image, and the picture as it would look in it.
    bare : (H, W) bool
        Pixels that show the support surface, and where the picture knows it.
    reach : float
        Standard deviation of the neighbourhood, pixels; 0 leaves the picture as it is.
    """
    if reach <= 0 or bare.sum() < _LEAST_PIXELS:
        return color
    block = max(1, int(reach / _STEPS))
    share = _block_means(bare[..., None].astype(np.float32), block)
    apart = _block_means((lab - color) * bare[..., None], block) / np.maximum(share, 1e-6)
    overall = np.median(apart[share[..., 0] > 0], axis=0)
    light = np.broadcast_to(overall, apart.shape)
    for _ in range(_ROUNDS):
        weight = share / (1 + ((apart - light) ** 2).sum(-1, keepdims=True) / _UNLIKE**2)
        known, extra = (_blur(item, reach / block) for item in (weight, weight * (apart - overall)))
        light = overall + extra / (known + _FEW)
    size = (light.shape[1] * block, light.shape[0] * block)
    full = cv2.resize(light.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
    return color + full[: bare.shape[0], : bare.shape[1]]


def _block_means(image: np.ndarray, block: int) -> np.ndarray:
    """Return the means (h, w, C) of the square blocks of an image (H, W, C), 0 outside of it."""
    rows, columns, channels = image.shape
    padded = np.pad(image, ((0, -rows % block), (0, -columns % block), (0, 0)))
    across = padded.reshape(padded.shape[0], -1, block, channels).mean(2)
    return across.reshape(-1, block, *across.shape[1:]).mean(1)


def _blur(image: np.ndarray, deviation: float) -> np.ndarray:
    """Return an image (h, w, C) blurred, 0 outside of it."""
    return gaussian_filter(image, (deviation, deviation, 0), mode="constant")
