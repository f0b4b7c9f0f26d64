"""How sharp an image is, and whether it shows anything."""

from __future__ import annotations

import cv2
import numpy as np

_NOISE_BLUR = 1.0  # pixels: takes sensor noise, which is fine detail too, out of the measure
_LEAST_ENERGY = 0.01  # grey levels squared: keeps the measure of a blank image near 0


def measure_sharpness(image: np.ndarray) -> float:
    """Measure the mean squared spatial frequency: energy of the Laplacian over that of the gradient.

    Larger is sharper. Blur takes the highest frequencies first; the ratio hardly changes with exposure, and less
    with what the image shows than the energy of detail itself does. For frames of one sequence.

    Parameters
    ----------
    image : (H, W, 3) uint8 RGB
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY).astype(np.float32)
    smooth = cv2.GaussianBlur(grey, (0, 0), _NOISE_BLUR)
    down, across = np.diff(smooth, axis=0), np.diff(smooth, axis=1)
    gradient = np.mean(np.square(down, dtype=np.float64)) + np.mean(np.square(across, dtype=np.float64))
    laplacian = np.mean(np.square(cv2.Laplacian(smooth, cv2.CV_32F), dtype=np.float64))
    return float(laplacian / (gradient + _LEAST_ENERGY))


def measure_contrast(image: np.ndarray) -> float:
    """Return the standard deviation of grey over the image (H, W, 3) uint8 RGB, in grey levels."""
    return float(np.std(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), dtype=np.float64))
