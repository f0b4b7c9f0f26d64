"""SLIC superpixels (Achanta et al. 2012): k-means of colour and place, within reach of each centre."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit

_ROUNDS = 10
_SMALLEST = 0.5
"""Pieces below this share of a cell of the grid of seeds join a neighbour."""


def cluster_pixels(image: np.ndarray, valid: np.ndarray, *, area: float, compactness: float) -> np.ndarray:
    """Cluster the pixels of an image into connected pieces of like colour.

    Parameters
    ----------
    image : (H, W, 3) uint8
        RGB.
    valid : (H, W) bool
        Pixels to cluster.
    area : float
        Of a piece on average, about, pixels.
    compactness : float
        Lab units of colour difference that weigh as much as the distance between two seeds.

    Returns
    -------
    (H, W) int32
        Numbers from 0 on, without gaps, in the order in which pieces are met row by row; -1 where not valid.
    """
    height, width = valid.shape
    lab = cv2.cvtColor(image.astype(np.float32) / np.float32(255), cv2.COLOR_RGB2Lab)
    spacing = np.sqrt(area)
    rows, columns = (_space_seeds(side, spacing) for side in (height, width))
    near = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1).reshape(-1, 2)
    centres = np.concatenate([lab[near[:, 0], near[:, 1]], near], axis=1).astype(np.float32)
    scale = np.float32((compactness / spacing) ** 2)
    nearest = np.full((height, width), -1, np.int32)
    for _ in range(_ROUNDS):
        _assign(lab, valid, centres, int(np.ceil(spacing)), scale, nearest)
        _move(lab, nearest, centres)
    return _connect(nearest, int(_SMALLEST * spacing**2))


def _space_seeds(side: int, spacing: float) -> np.ndarray:
    number = max(1, round(side / spacing))
    return ((np.arange(number) + 0.5) * side / number).astype(np.int64)


@njit(nogil=True, cache=True)
def _assign(lab, valid, centres, reach, scale, nearest):
    """Give each pixel the centre of least distance among those at most `reach` away in rows and columns."""
    height, width = valid.shape
    least = np.full((height, width), np.float32(np.inf))
    distances = np.empty(2 * reach + 1, np.float32)
    nearest[:] = -1
    for k in range(len(centres)):
        light, a, b, v, u = centres[k]
        first = max(int(u) - reach, 0)
        last = min(int(u) + reach + 1, width)
        for row in range(max(int(v) - reach, 0), min(int(v) + reach + 1, height)):
            down = (row - v) * (row - v)
            colours = lab[row, first:last]
            best, owner = least[row, first:last], nearest[row, first:last]
            for i in range(last - first):
                across = np.float32(first + i) - u
                d0, d1, d2 = colours[i, 0] - light, colours[i, 1] - a, colours[i, 2] - b
                distances[i] = d0 * d0 + d1 * d1 + d2 * d2 + scale * (across * across + down)
            for i in range(last - first):
                if distances[i] < best[i]:
                    best[i] = distances[i]
                    owner[i] = k
    for row in range(height):
        for column in range(width):
            if not valid[row, column]:
                nearest[row, column] = -1


@njit(nogil=True, cache=True)
def _move(lab, nearest, centres):
    """Move each centre to the mean of its pixels; one without any stays."""
    height, width = nearest.shape
    total = np.zeros((len(centres), 5))
    members = np.zeros(len(centres))
    for row in range(height):
        for column in range(width):
            k = nearest[row, column]
            if k >= 0:
                for c in range(3):
                    total[k, c] += lab[row, column, c]
                total[k, 3] += row
                total[k, 4] += column
                members[k] += 1
    for k in range(len(centres)):
        if members[k] > 0:
            for c in range(5):
                centres[k, c] = total[k, c] / members[k]


@njit(nogil=True, cache=True)
def _connect(nearest, smallest):
    """Number connected pieces row by row; a small one joins one beside it, if there is any."""
    height, width = nearest.shape
    index = np.full((height, width), -1, np.int32)
    queue = np.empty((height * width, 2), np.int32)
    number = 0
    for v in range(height):
        for u in range(width):
            if nearest[v, u] < 0 or index[v, u] >= 0:
                continue
            beside = -1
            index[v, u] = number
            queue[0] = v, u
            size, done = 1, 0
            while done < size:
                row, column = queue[done]
                done += 1
                for down, across in ((-1, 0), (0, -1), (0, 1), (1, 0)):
                    y, x = row + down, column + across
                    if y < 0 or x < 0 or y >= height or x >= width:
                        continue
                    if index[y, x] >= 0:
                        if beside < 0 and index[y, x] != number:
                            beside = index[y, x]
                    elif nearest[y, x] == nearest[v, u]:
                        index[y, x] = number
                        queue[size] = y, x
                        size += 1
            if size < smallest and beside >= 0:
                for i in range(size):
                    index[queue[i, 0], queue[i, 1]] = beside
            else:
                number += 1
    return index
