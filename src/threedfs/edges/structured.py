"""Contour strength by a structured forest (Dollar and Zitnick 2013)."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numba import njit

from threedfs.edges.channels import compute_channels, smooth_triangle
from threedfs.edges.forest import LABEL, WINDOW, Forest, feature_table

SCALES = (0.5, 1.0, 2.0)
"""At which contours are sought: coarse ones look past texture, fine ones place the contour."""

_PAD = WINDOW + LABEL // 2  # half a window, and as much that the labels of all windows are complete in the image


def structured_contours(
    image: np.ndarray, valid: np.ndarray, forest: Forest, scales: Sequence[float] = SCALES
) -> np.ndarray:
    """Measure contour strength: the share of trees that see a contour, averaged over scales.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    valid : (H, W) bool
        Pixels that show the scene; elsewhere, and at its border, the strength is 0.
    forest : Forest
    scales : sequence of float
        Factors by which the image is resized; 1 is its own size.

    Returns
    -------
    (H, W) float32
        In [0, 1].
    """
    if not valid.any():
        return np.zeros(valid.shape, np.float32)
    height, width = valid.shape
    filled = _extend(image, valid)
    total = np.zeros(valid.shape, np.float32)
    for scale in scales:
        size = (max(round(width * scale), 1), max(round(height * scale), 1))
        method = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
        resized = filled if size == (width, height) else cv2.resize(filled, size, interpolation=method)
        strength = _detect(resized, forest)
        total += strength if size == (width, height) else cv2.resize(strength, (width, height))
    interior = cv2.erode(valid.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1) > 0
    return np.where(interior, np.clip(total / np.float32(len(scales)), 0, 1), np.float32(0))


def _extend(image, valid):
    """Give pixels outside of `valid` the colour of the nearest inside: a step at its border would be a contour."""
    if valid.all():
        return image
    _, nearest = cv2.distanceTransformWithLabels(
        (~valid).astype(np.uint8), cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL
    )
    colours = np.zeros((int(nearest.max()) + 1, 3), np.uint8)
    colours[nearest[valid]] = image[valid]
    return colours[nearest]


def _detect(image, forest):
    """Contour strength (H, W) float32 of an image at its own scale."""
    height, width = image.shape[:2]
    # To even sizes: the channels have half the resolution.
    bottom, right = _PAD + height % 2, _PAD + width % 2
    padded = cv2.copyMakeBorder(image, _PAD, bottom, _PAD, right, cv2.BORDER_REFLECT)
    fine, coarse = compute_channels(padded)
    votes = np.zeros(padded.shape[:2], np.int32)
    used = cast_votes(fine, coarse, forest, votes)
    # Each pixel lies in the labels of (LABEL / 2)^2 windows, each seen by so many trees.
    strength = votes.astype(np.float32) / np.float32(used * LABEL * LABEL / 4)
    return smooth_triangle(strength, 1)[_PAD : _PAD + height, _PAD : _PAD + width]


def cast_votes(fine: np.ndarray, coarse: np.ndarray, forest: Forest, votes: np.ndarray) -> int:
    """Count, in `votes` (H, W) int32, the leaves whose contours pass a pixel; return how many trees see a window.

    Trees take turns: neighbouring windows are seen by different halves of them.
    """
    # What nodes and leaves refer to, as distances from a window's first pixel in arrays taken as flat.
    stride, channels = fine.shape[1], fine.shape[2]
    asked = feature_table()[np.maximum(forest.feature, 0)].astype(np.int64)
    first = (asked[:, 1] * stride + asked[:, 2]) * channels + asked[:, 0]
    second = np.where(asked[:, 3] < 0, -1, (asked[:, 3] * stride + asked[:, 4]) * channels + asked[:, 0])
    second = np.where(forest.feature < 0, -2, second)
    nodes = np.column_stack([first, second, forest.child]).astype(np.int32)
    patch, row, column = list_contours(forest.labels)
    margin = WINDOW - LABEL // 2  # from the window's first pixel in the image to the label's
    pixels = ((row + margin) * votes.shape[1] + column + margin).astype(np.int32)
    starts = np.searchsorted(patch, np.arange(len(forest.labels) + 1)).astype(np.int32)
    used = max(len(forest.roots) // 2, 1)
    _cast(fine.ravel(), coarse.ravel(), fine.shape, forest.roots, nodes, forest.threshold, pixels, starts, used, votes)
    return used


def list_contours(labels: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """List pixels that touch another segment: their patches in ascending order, rows and columns, each (P,) int64."""
    across, down = labels[:, :, 1:] != labels[:, :, :-1], labels[:, 1:] != labels[:, :-1]
    contour = np.zeros(labels.shape, bool)
    contour[:, :, 1:] |= across
    contour[:, :, :-1] |= across
    contour[:, 1:] |= down
    contour[:, :-1] |= down
    return np.nonzero(contour)


@njit(cache=True)
def _cast(fine, coarse, shape, roots, nodes, threshold, pixels, starts, used, votes):
    """Send every window down its trees. Counts are integers, so their order does not matter."""
    width = votes.shape[1]
    flat = votes.ravel()
    for top in range(shape[0] - WINDOW + 1):
        for left in range(shape[1] - WINDOW + 1):
            corner = (top * shape[1] + left) * shape[2]
            turn = (top + left) % 2 * used if len(roots) > 1 else 0
            for tree in range(turn, turn + used):
                node = roots[tree]
                while nodes[node, 1] != -2:
                    if nodes[node, 1] < 0:
                        value = fine[corner + nodes[node, 0]]
                    else:
                        value = coarse[corner + nodes[node, 0]] - coarse[corner + nodes[node, 1]]
                    node = nodes[node, 2] if value < threshold[node] else nodes[node, 2] + 1
                leaf = nodes[node, 2]
                place = 2 * (top * width + left)
                for k in range(starts[leaf], starts[leaf + 1]):
                    flat[place + pixels[k]] += 1
