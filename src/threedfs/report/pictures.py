"""Pictures of what a run found: outlines, depth and normals as colours, images inside of a page."""

from __future__ import annotations

import base64
import math

import cv2
import numpy as np

from threedfs.types import Keyframe

_GREEN = (0, 255, 0)
_SMALLEST = 80
"""Pixels along the longer side, below which no picture is worth a look."""


def outline_mask(image: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Return a copy of an image (H, W, 3) uint8 RGB with the outline of a mask (H, W) bool in green."""
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    width = max(1, round(max(mask.shape) / 300))
    return cv2.drawContours(np.array(image, order="C"), contours, -1, _GREEN, width)


def color_depth(depth: np.ndarray, keyframe: Keyframe) -> np.ndarray:
    """Return inverse depth over the keyframe's expected range as colours (H, W, 3) uint8 RGB; near is red."""
    near, far = 1 / keyframe.near, 1 / keyframe.far
    level = np.clip((1 / depth - far) / (near - far), 0, 1)
    return cv2.applyColorMap((np.nan_to_num(level) * 255).astype(np.uint8), cv2.COLORMAP_TURBO)[..., ::-1]


def color_normals(normals: np.ndarray) -> np.ndarray:
    """Return normals (H, W, 3) that face the camera as colours: x red, y green, towards the camera blue."""
    return (np.nan_to_num(normals * [0.5, 0.5, -0.5] + 0.5) * 255).clip(0, 255).astype(np.uint8)


def embed_image(image: np.ndarray, longest: int, quality: int = 80, most: float = math.inf) -> str:
    """Return an RGB image (H, W, 3) uint8 as the address of an image in a page.

    Parameters
    ----------
    image : (H, W, 3) uint8
    longest : int
        Pixels along its longer side, at most.
    quality : int
        Of the JPEG.
    most : float
        Characters that the address may have: a larger one is drawn smaller, down to `_SMALLEST` pixels.
    """
    address = _encode(image, longest, quality)
    while len(address) > most and longest > _SMALLEST:
        # an image of half the pixels takes more than half the bytes, hence the factor
        longest = max(_SMALLEST, int(0.9 * longest * math.sqrt(most / len(address))))
        address = _encode(image, longest, quality)
    return address


def _encode(image: np.ndarray, longest: int, quality: int) -> str:
    scale = min(1.0, longest / max(image.shape[:2]))
    size = (max(1, round(scale * image.shape[1])), max(1, round(scale * image.shape[0])))
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA) if scale < 1 else image
    data = cv2.imencode(".jpg", np.ascontiguousarray(small[..., ::-1]), [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return "data:image/jpeg;base64," + base64.b64encode(data.tobytes()).decode()
