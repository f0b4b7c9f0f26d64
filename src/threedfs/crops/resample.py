"""A crop's pixels, resampled once from those that were filmed, with the lens undistorted in the same step."""

from __future__ import annotations

from math import ceil

import cv2
import numpy as np
from numba import njit

from threedfs.frames.scale import shrink
from threedfs.geometry.distortion import turning_radius
from threedfs.geometry.lens import Lens
from threedfs.types import Camera

_FOOTPRINT = 1.0
"""Pixels on either side, beside the nearest ones, that cv2.INTER_CUBIC reads."""
_NOWHERE = -1e4
"""A coordinate outside any image."""


def resample(image: np.ndarray, lens: Lens, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Return what an ideal camera at the same place sees, and which of its pixels the image shows.

    Interpolated on a grid at least as fine as the image, then averaged over each pixel's area, so that nothing aliases;
    bicubic where pixels are as large as the image's.

    Parameters
    ----------
    image : (Hs, Ws, 3) uint8
        As filmed.
    lens : Lens
        Of the image.
    camera : Camera
        Of the crop.

    Returns
    -------
    crop : (H, W, 3) uint8
        Repeats the border where the image shows nothing.
    valid : (H, W) bool
        As `find_valid` returns it.
    """
    finer = _refinement(lens, camera)
    places, valid = _filmed_places(lens, camera, finer)
    # what is averaged afterwards needs no more than linear interpolation
    way = cv2.INTER_CUBIC if finer == 1 else cv2.INTER_LINEAR
    sampled = cv2.remap(image, places, None, way, borderMode=cv2.BORDER_REPLICATE)
    return shrink(sampled, camera.shape), valid


def find_valid(lens: Lens, camera: Camera) -> np.ndarray:
    """Say which pixels (H, W) bool of a crop are made from pixels of the image alone."""
    return _filmed_places(lens, camera, _refinement(lens, camera))[1]


def _refinement(lens: Lens, camera: Camera) -> int:
    """Return the whole number of samples along a crop's pixel at which they lie no farther apart than the image's."""
    return max(1, ceil(lens.camera.fx / camera.fx - 1e-3))


def _filmed_places(lens: Lens, camera: Camera, finer: int) -> tuple[np.ndarray, np.ndarray]:
    """Return where each sample of an ideal camera lies in the image as filmed, and which pixels lie on it wholly.

    Returns
    -------
    places : (finer H, finer W, 2) float32
        (u, v).
    inside : (H, W) bool
        Pixels all of whose samples are on the image; its outermost pixels count if no lens bends it.
    """
    fine = Lens(camera).resize(camera.width * finer, camera.height * finer).camera
    places, inside = np.empty((*fine.shape, 2), np.float32), np.ones(camera.shape, bool)
    filmed = (lens.camera.fx, lens.camera.fy, lens.camera.cx, lens.camera.cy)
    turning = min(turning_radius((lens.k1, lens.k2)) ** 2, np.finfo(np.float64).max)
    reach = _FOOTPRINT if lens.k1 or lens.k2 else -0.5
    last = (lens.camera.width - 1 - reach, lens.camera.height - 1 - reach)
    _distort(
        fine.fx, fine.fy, fine.cx, fine.cy, filmed, (lens.k1, lens.k2), turning, reach, last, finer, places, inside
    )
    return places, inside


@njit(nogil=True, cache=True)
def _distort(fx, fy, cx, cy, filmed, distortion, turning, first, last, finer, places, inside):
    """Write where each sample lies in the image of a lens, as `geometry.distortion.distort`, and pixels without it."""
    for row in range(places.shape[0]):
        y = (row - cy) / fy
        for column in range(places.shape[1]):
            x = (column - cx) / fx
            square = x * x + y * y
            if square < turning:
                factor = 1 + square * (distortion[0] + square * distortion[1])
                places[row, column, 0] = x * factor * filmed[0] + filmed[2]
                places[row, column, 1] = y * factor * filmed[1] + filmed[3]
            else:
                places[row, column] = _NOWHERE
            u, v = places[row, column, 0], places[row, column, 1]
            if u < first or v < first or u > last[0] or v > last[1]:
                inside[row // finer, column // finer] = False
