"""A forest whose leaves hold small segmentations, and what its nodes ask of an image's channels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from threedfs.edges.channels import CHANNELS

WINDOW = 16
"""Side of what a tree looks at, in pixels of the channels: 32 of the image."""
LABEL = 16
"""Side of a leaf's segmentation, in pixels of the image: the middle of the window."""
_CELLS = 5
_PAIRS = _CELLS * (_CELLS - 1) * _CELLS * (_CELLS + 1) // 2
FINE_FEATURES = WINDOW * WINDOW * CHANNELS
FEATURES = FINE_FEATURES + _PAIRS * CHANNELS


@dataclass(frozen=True)
class Forest:
    """Trees in one table of nodes.

    Attributes
    ----------
    roots : (T,) int32
        Node at which each tree begins.
    feature : (N,) int32
        What a node asks for, see `read_feature`; -1 in leaves.
    threshold : (N,) float32
        A sample whose feature is smaller goes to `child`, others to the node after it.
    child : (N,) int32
        Of leaves: the row of `labels`.
    labels : (L, 16, 16) uint8
        Segment of each pixel, counted from 0.
    """

    roots: np.ndarray
    feature: np.ndarray
    threshold: np.ndarray
    child: np.ndarray
    labels: np.ndarray


def feature_table() -> np.ndarray:
    """Tabulate what features are: (F, 5) int32 of channel, row and column, and row and column of a second place.

    First come single values of the fine channels, whose second row is -1; then differences of the coarse channels
    between the centres of 5 x 5 cells.
    """
    table = np.full((FEATURES, 5), -1, np.int32)
    row, column, channel = np.meshgrid(np.arange(WINDOW), np.arange(WINDOW), np.arange(CHANNELS), indexing="ij")
    table[:FINE_FEATURES, :3] = np.column_stack([channel.ravel(), row.ravel(), column.ravel()])
    centres = ((np.arange(_CELLS) + 0.5) * WINDOW / _CELLS).astype(np.int32)
    places = np.stack(np.meshgrid(centres, centres, indexing="ij"), axis=-1).reshape(-1, 2)
    first, second = np.triu_indices(len(places), 1)
    for channel in range(CHANNELS):
        rows = table[FINE_FEATURES + channel * _PAIRS : FINE_FEATURES + (channel + 1) * _PAIRS]
        rows[:, 0], rows[:, 1:3], rows[:, 3:] = channel, places[first], places[second]
    return table


@njit(cache=True, inline="always")
def read_feature(fine, coarse, top, left, entry):
    """Read one feature of the window whose first pixel is (top, left); `entry` is a row of `feature_table`."""
    channel, row, column = entry[0], top + entry[1], left + entry[2]
    if entry[3] < 0:
        return fine[row, column, channel]
    return coarse[row, column, channel] - coarse[top + entry[3], left + entry[4], channel]
