"""SIFT keypoints and descriptors of frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor

import cv2
import numpy as np

from threedfs.types import Features

_LEVELS = 3  # of an octave
_LENGTH = 512  # of a descriptor


def choose_frames(times: np.ndarray, most: int, max_gap: float, *, ordered: bool) -> list[int]:
    """Choose frames of a video at uniform steps, from the first; of photos all.

    Parameters
    ----------
    times : (N,) float64
        Of all frames, seconds.
    most : int
        Frames to choose at most, as far as `max_gap` allows.
    max_gap : float
        Longest time between two chosen frames that are no neighbours, seconds.
    ordered : bool
        Whether they are a video's.

    Examples
    --------
    >>> choose_frames(np.arange(7) / 10, 4, 0.5, ordered=True)
    [0, 2, 4, 6]
    >>> choose_frames(np.arange(3) / 2, 2, 0.5, ordered=True)
    [0, 1, 2]
    """
    step = 1
    if ordered and len(times) > most:
        step = max(1, min(-(-len(times) // most), int(max_gap / np.median(np.diff(times)) + 1e-6)))
    return list(range(0, len(times), step))


def find_keypoints(
    read_image: Callable[[int], np.ndarray],
    frames: Sequence[int],
    *,
    max_features: int,
    min_contrast: float,
    threads: int,
) -> dict[int, Features]:
    """Find the keypoints of frames, each frame on one thread.

    Parameters
    ----------
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a frame by its number.
    frames : sequence of int
    max_features, min_contrast : int, float
        See `describe_image`.
    threads : int
        Frames worked on at the same time; changes no result.

    Returns
    -------
    dict
        Features by frame number, in the order of `frames`.
    """

    def describe(frame: int) -> Features:
        return describe_image(read_image(frame), max_features=max_features, min_contrast=min_contrast)

    with ThreadPoolExecutor(threads) as pool:
        return dict(zip(frames, pool.map(describe, frames), strict=True))


def describe_image(image: np.ndarray, *, max_features: int, min_contrast: float) -> Features:
    """Find the keypoints of one image.

    Parameters
    ----------
    image : (H, W, 3) uint8 RGB
    max_features : int
        Most keypoints, the largest kept.
    min_contrast : float
        Least contrast of a keypoint, of the grey range.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    # OpenCV divides the contrast by the levels of an octave. Without precise upscaling pixels are a quarter off.
    sift = cv2.SIFT_create(
        nfeatures=0,
        nOctaveLayers=_LEVELS,
        contrastThreshold=_LEVELS * min_contrast,
        enable_precise_upscale=True,
    )
    every = sift.detect(grey, None)
    largest = np.argsort([-point.size for point in every], kind="stable")[:max_features]
    kept, descriptors = sift.compute(grey, [every[index] for index in np.sort(largest)])
    if not kept:
        return Features(np.zeros((0, 2)), np.zeros((0, 128), np.uint8), np.zeros((0, 3), np.uint8))
    pixels = np.array([point.pt for point in kept], np.float64)
    column, row = np.clip(np.rint(pixels).astype(int), 0, np.array(image.shape[1::-1]) - 1).T
    return Features(pixels, _root_normalise(descriptors), image[row, column])


def _root_normalise(descriptors: np.ndarray) -> np.ndarray:
    """Take the square root of the share that each bin has of a descriptor; return bytes of length about 512."""
    total = np.maximum(descriptors.sum(axis=1, keepdims=True), 1e-12)
    return np.rint(_LENGTH * np.sqrt(descriptors / total)).clip(0, 255).astype(np.uint8)
