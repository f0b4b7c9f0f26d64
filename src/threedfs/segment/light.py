"""How the light of one image differs from that of the support surface's picture: exposure, white balance, gloss."""

from __future__ import annotations

import cv2
import numpy as np
from scipy.ndimage import gaussian_filter

_LEAST_PIXELS = 100
"""Pixels that show the support surface bare, without which nothing is known of an image's light."""
_UNLIKE = 20.0
"""Distance in Lab from what is expected at which a pixel counts half: print a pixel off, a thing that was moved."""
_ROUNDS = 2
"""Times that the light is estimated, each by pixels that were like the estimate before."""
_FEW = 0.005
"""Share of such pixels around a place below which the light is that of the whole image rather."""
_STEPS = 4.0
"""Steps of the coarse image in `reach`."""


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
    apart = lab - color
    light = np.broadcast_to(np.median(apart[bare], axis=0), apart.shape)
    overall = light
    block = max(1, int(reach / _STEPS))
    for _ in range(_ROUNDS):
        weight = bare / (1 + ((apart - light) ** 2).sum(-1) / _UNLIKE**2)
        share = _blur(weight, block, reach)
        extra = [_blur(weight * (apart - overall)[..., channel], block, reach) for channel in range(3)]
        coarse = np.stack(extra, axis=-1) / (share + _FEW)[..., None]
        light = overall + _enlarge(coarse, block, bare.shape)
    return (color + light).astype(np.float32)


def _blur(image: np.ndarray, block: int, reach: float) -> np.ndarray:
    """Return the means of an image's blocks, blurred; what lies outside of the image is 0."""
    rows, columns = image.shape
    padded = np.pad(image, ((0, -rows % block), (0, -columns % block)))
    means = padded.reshape(padded.shape[0] // block, block, padded.shape[1] // block, block).mean((1, 3))
    return gaussian_filter(means, reach / block, mode="constant")


def _enlarge(coarse: np.ndarray, block: int, shape: tuple[int, int]) -> np.ndarray:
    """Return an image of blocks (h, w, 3) at its full shape, linear between the middles of blocks."""
    size = (coarse.shape[1] * block, coarse.shape[0] * block)
    full = cv2.resize(coarse.astype(np.float32), size, interpolation=cv2.INTER_LINEAR)
    return full[: shape[0], : shape[1]]
