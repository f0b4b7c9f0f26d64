"""Thin contours: non-maximum suppression across their direction."""

from __future__ import annotations

import cv2
import numpy as np

from threedfs.edges.channels import smooth_triangle

_SMOOTHING = 4  # radius over which the direction of a contour is estimated, pixels
_TOLERANCE = 1.01  # a neighbour must be larger by this factor to suppress


def thin(strength: np.ndarray) -> np.ndarray:
    """Keep the strength of pixels that are the maximum across their contour; others become 0.

    The direction comes from the second derivatives of the smoothed strength; what lies a pixel beside is interpolated.

    Parameters
    ----------
    strength : (H, W) float32

    Returns
    -------
    (H, W) float32
    """
    smooth = smooth_triangle(strength.astype(np.float32), _SMOOTHING)
    by_row, by_column = np.gradient(smooth)
    vv, uu = np.gradient(by_row, axis=0), np.gradient(by_column, axis=1)
    uv = np.gradient(by_column, axis=0)
    # Across a contour lies the eigenvector of the Hessian with the largest magnitude: negative on the ridge, positive
    # on its flanks.
    angle = 0.5 * np.arctan2(2 * uv, uu - vv) + np.where(uu + vv < 0, np.pi / 2, 0)
    u, v = np.meshgrid(np.arange(strength.shape[1]), np.arange(strength.shape[0]))
    peak = strength > 0
    for side in (-1, 1):
        beside = cv2.remap(
            strength.astype(np.float32),
            (u + side * np.cos(angle)).astype(np.float32),
            (v + side * np.sin(angle)).astype(np.float32),
            cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )
        peak &= strength * _TOLERANCE >= beside
    return np.where(peak, strength, 0).astype(np.float32)
