"""A picture whose contours are known, and label patches cut from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit


@dataclass(frozen=True)
class Picture:
    """An image, and which neighbouring pixels belong to one segment.

    Attributes
    ----------
    image : (H, W, 3) uint8
        RGB.
    right, down : (H, W) bool
        No contour separates the pixel from the one right of it, or below it.
    """

    image: np.ndarray
    right: np.ndarray
    down: np.ndarray


def link_segments(segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return `right` and `down` (H, W) bool of a `Picture` whose segments (H, W) are numbered."""
    right, down = np.ones(segments.shape, bool), np.ones(segments.shape, bool)
    right[:, :-1] = segments[:, 1:] == segments[:, :-1]
    down[:-1] = segments[1:] == segments[:-1]
    return right, down


def contour_pixels(picture: Picture) -> np.ndarray:
    """Return (H, W) bool: pixels with a contour on their right or lower side, one pixel wide."""
    return ~picture.right | ~picture.down


@njit(cache=True)
def cut_label(right, down, top, left, label):
    """Fill `label` (S, S) uint8 with the connected pieces of the patch at (top, left), numbered in row order.

    A contour that ends inside of the patch separates nothing. Returns the number of pieces; above 255 pieces
    are not told apart.
    """
    size = label.shape[0]
    parent = np.arange(size * size)
    for row in range(size):
        for column in range(size):
            here = row * size + column
            for step in range(2):
                if step == 0 and (column + 1 == size or not right[top + row, left + column]):
                    continue
                if step == 1 and (row + 1 == size or not down[top + row, left + column]):
                    continue
                one, other = here, here + (1 if step == 0 else size)
                while parent[one] != one:
                    one = parent[one]
                while parent[other] != other:
                    other = parent[other]
                parent[max(one, other)] = min(one, other)
    count = 0
    for here in range(size * size):
        root = here
        while parent[root] != root:
            root = parent[root]
        if root == here:
            label[here // size, here % size] = min(count, 255)
            count += 1
        else:
            label[here // size, here % size] = label[root // size, root % size]
    return count
