"""Zero-mean normalised cross-correlation of square patches, for whole images at once."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit

MISSING = np.float32(-1e9)
"""Grey value of a pixel that no image shows: so low that a patch which touches one, or a sample interpolated with
the least share of one, has a sum far below every real patch."""

_LEAST_VARIANCE = np.float32(0.02)
"""Grey levels squared; under it a patch is flat, and rounding would decide its correlation."""


@dataclass(frozen=True)
class PatchStatistics:
    """The reference image's share of the correlation, computed once.

    Attributes
    ----------
    mean : (H, W) float32, over the patch
    variance : (H, W) float32, over the patch, grey levels squared
    inverse_deviation : (H, W) float32, 1 / sqrt(variance + floor); 0 where the patch leaves the valid image
    """

    mean: np.ndarray
    variance: np.ndarray
    inverse_deviation: np.ndarray

    @property
    def complete(self) -> np.ndarray:
        """(H, W) bool, where the whole patch lies on the valid image."""
        return self.inverse_deviation > 0


def prepare_grey(image: np.ndarray, valid: np.ndarray) -> np.ndarray:
    """Return centred grey levels (H, W) float32 of an RGB image, `MISSING` where it is not valid.

    Centring at mid-grey keeps single-precision sums of squares exact enough; the correlation does not change.
    """
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY).astype(np.float32) - np.float32(128)
    return np.where(valid, grey, MISSING)


def describe_patches(grey: np.ndarray, radius: int, variance_floor: float) -> PatchStatistics:
    """Compute mean and spread of the patch around every pixel.

    Parameters
    ----------
    grey : (H, W) float32
        Grey levels 0..255, `MISSING` where the image shows nothing.
    radius : int
        Patches are (2 radius + 1)^2 pixels.
    variance_floor : float
        Added to each variance, grey levels squared: sensor noise must not pass for texture.
    """
    return PatchStatistics(*_patch_statistics(grey, radius, np.float32(variance_floor)))


@njit(cache=True)
def _patch_statistics(grey, radius, floor):
    height, width = grey.shape
    mean = np.zeros_like(grey)
    variance = np.zeros_like(grey)
    inverse_deviation = np.zeros_like(grey)
    count = np.float32((2 * radius + 1) ** 2)
    for v in range(radius, height - radius):
        for u in range(radius, width - radius):
            total = 0.0
            for dv in range(-radius, radius + 1):
                for du in range(-radius, radius + 1):
                    total += grey[v + dv, u + du]
            if total < -1e5:
                continue
            average = total / count
            square = 0.0
            for dv in range(-radius, radius + 1):
                for du in range(-radius, radius + 1):
                    square += (grey[v + dv, u + du] - average) ** 2
            mean[v, u] = average
            variance[v, u] = square / count
            inverse_deviation[v, u] = 1 / np.sqrt(max(square / count + floor, _LEAST_VARIANCE))
    return mean, variance, inverse_deviation


@njit(cache=True, error_model="numpy")
def accumulate_cost(warped, grey, mean, inverse_deviation, radius, floor, missing_cost, column, patch, cost):
    """Add (1 - ZNCC) / 2 of every patch pair to `cost` in place (the summand of Eq. 1).

    Each inner loop runs along a row and has no other loop, branch or checked division in it, so that it compiles
    to vector instructions.

    Parameters
    ----------
    warped : (H, W) float32
        The neighbour image seen through one depth plane, `MISSING` outside it.
    grey, mean, inverse_deviation : (H, W) float32
        `PatchStatistics` of the reference image.
    radius, floor : int, float32
        As in `describe_patches`.
    missing_cost : float32
        Charged where the neighbour does not show the patch.
    column, patch : (3, W) float32
        Scratch: sums of values, squares and products over a patch's column, and over the patch.
    cost : (H, W) float32
        Changed in place; pixels closer than `radius` to the border get `missing_cost`.
    """
    height, width = grey.shape
    inner = width - 2 * radius
    scale = np.float32(1.0 / ((2 * radius + 1) ** 2))
    half = np.float32(0.5)
    column_sum, column_square, column_product = column[0], column[1], column[2]
    patch_sum, patch_square, patch_product = patch[0], patch[1], patch[2]
    for v in range(height):
        row = cost[v]
        if v < radius or v >= height - radius:
            for u in range(width):
                row[u] += missing_cost
            continue
        column[:] = 0
        for dv in range(-radius, radius + 1):
            warped_row = warped[v + dv]
            grey_row = grey[v + dv]
            for u in range(width):
                value = warped_row[u]
                column_sum[u] += value
                column_square[u] += value * value
                column_product[u] += value * grey_row[u]
        for k in range(3):
            out = patch[k]
            centre = column[k, radius:]
            for u in range(inner):
                out[u] = centre[u]
            for du in range(1, radius + 1):
                before = column[k, radius - du :]
                after = column[k, radius + du :]
                for u in range(inner):
                    out[u] += before[u] + after[u]
        for u in range(radius):
            row[u] += missing_cost
            row[width - 1 - u] += missing_cost
        mean_row = mean[v, radius:]
        spread_row = inverse_deviation[v, radius:]
        inner_row = row[radius:]
        for u in range(inner):
            total = patch_sum[u]
            average = total * scale
            variance = max(patch_square[u] * scale - average * average + floor, _LEAST_VARIANCE)
            covariance = patch_product[u] * scale - average * mean_row[u]
            correlation = covariance * spread_row[u] / np.sqrt(variance)
            correlation = min(max(correlation, np.float32(-1)), np.float32(1))
            known = total > np.float32(-1e5)
            inner_row[u] += half * (np.float32(1) - correlation) if known else missing_cost
