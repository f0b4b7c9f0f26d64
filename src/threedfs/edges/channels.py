"""What a contour detector looks at: colour, gradient magnitude and gradient orientation, at half the resolution."""

from __future__ import annotations

import cv2
import numpy as np

CHANNELS = 13
_ORIENTATIONS = 4
_MAGNITUDE_FLOOR = 0.01  # keeps the noise of blank areas from being normalised to full strength
_LUV_RANGE = 270.0


def compute_channels(image: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the 13 channels of an image, smoothed a little and smoothed a lot (Dollar and Zitnick 2013, 3.1).

    They are L, u, v; then at full and at half resolution the gradient magnitude and its share in each of four
    orientations. Magnitudes are divided by their mean around the pixel, which evens out contrast.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB, H and W even.

    Returns
    -------
    fine, coarse : (H / 2, W / 2, 13) float32
        Smoothed by triangles of radius 1 and 4 pixels of theirs.
    """
    luv = cv2.cvtColor(image.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2Luv) / np.float32(_LUV_RANGE)
    size = (image.shape[1] // 2, image.shape[0] // 2)
    half = cv2.resize(luv, size, interpolation=cv2.INTER_AREA)
    layers = [half]
    for source in (luv, half):
        magnitude, shares = _gradients(source)
        stack = np.dstack([magnitude, *shares])
        layers.append(stack if source is half else cv2.resize(stack, size, interpolation=cv2.INTER_AREA))
    channels = np.dstack(layers)
    return smooth_triangle(channels, 1), smooth_triangle(channels, 4)


def smooth_triangle(channels: np.ndarray, radius: int) -> np.ndarray:
    """Convolve channels (H, W) or (H, W, C) float32 with a triangle of `radius` pixels on either side."""
    kernel = (radius + 1 - np.abs(np.arange(-radius, radius + 1))).astype(np.float32)
    kernel /= kernel.sum()
    if channels.ndim == 2:
        return _separable(channels, kernel)
    # OpenCV filters at most four channels at once.
    return np.dstack([_separable(np.ascontiguousarray(channels[..., c]), kernel) for c in range(channels.shape[2])])


def _separable(channel, kernel):
    return cv2.sepFilter2D(channel, cv2.CV_32F, kernel, kernel, borderType=cv2.BORDER_REFLECT)


def _gradients(luv):
    """Return the normalised gradient magnitude (H, W) and its share in each orientation, all float32.

    At each pixel the colour channel with the largest gradient counts.
    """
    padded = cv2.copyMakeBorder(luv, 1, 1, 1, 1, cv2.BORDER_REPLICATE)
    along_u = (padded[1:-1, 2:] - padded[1:-1, :-2]) / 2
    along_v = (padded[2:, 1:-1] - padded[:-2, 1:-1]) / 2
    square = along_u**2 + along_v**2
    strongest = square.argmax(axis=-1)[..., None]
    u, v, largest = (np.take_along_axis(field, strongest, -1)[..., 0] for field in (along_u, along_v, square))
    magnitude = np.sqrt(largest)
    magnitude = magnitude / (smooth_triangle(magnitude, 4) + np.float32(_MAGNITUDE_FLOOR))
    # Orientation modulo 180 degrees, shared linearly between the two nearest of four.
    position = cv2.phase(u, v) * np.float32(_ORIENTATIONS / np.pi)
    shares = []
    for k in range(_ORIENTATIONS):
        offset = np.abs(np.mod(position - k + _ORIENTATIONS / 2, _ORIENTATIONS) - _ORIENTATIONS / 2)
        shares.append((magnitude * np.maximum(1 - offset, 0)).astype(np.float32))
    return magnitude, shares
