"""Exposure and white balance of each photograph, against the others'."""

from __future__ import annotations

import warnings

import cv2
import numpy as np

from threedfs.texture.vertices import ABSENT, median_samples

_ROUNDS = 2
_LEAST = 8
"""Level below which a sample tells no ratio."""
_PEAK = 255


def find_gains(samples: np.ndarray) -> np.ndarray:
    """Return the gain (views, 3) of each view's red, green and blue that brings it to the median of all.

    A phone changes its exposure while it films. The median ratio counts, as a highlight or a thing in between is a
    part of a view. The mean gain is 1.

    Parameters
    ----------
    samples : (views, V, 3) uint16
        As `sample_vertices` returns them.
    """
    levels = np.where((samples >= _LEAST) & (samples < ABSENT), samples, np.nan)
    gains = np.ones((len(samples), 3))
    for _ in range(_ROUNDS):
        middle = median_samples(apply_gains(samples, gains))[0]
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # a view that sees nothing has no median: gain 1
            gains = np.nanmedian(middle / levels, axis=1)
        gains = np.where(gains > 0, gains, 1.0)
        gains /= gains.mean(axis=0)
    return gains


def apply_gains(samples: np.ndarray, gains: np.ndarray) -> np.ndarray:
    """Return the samples (views, V, 3) uint16 as the gains (views, 3) make them."""
    levels = np.clip(np.rint(samples * gains[:, None]), 0, _PEAK).astype(np.uint16)
    return np.where(samples < ABSENT, levels, np.uint16(ABSENT))


def expose(image: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Return an image (H, W, 3) uint8 as a gain (3,) makes it."""
    level = np.arange(_PEAK + 1)[:, None]
    return cv2.LUT(image, np.clip(np.rint(level * gain), 0, _PEAK).astype(np.uint8)[None])
