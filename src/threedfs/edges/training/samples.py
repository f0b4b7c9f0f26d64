"""Windows of pictures as samples: their features and their label patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit

from threedfs.edges.channels import compute_channels
from threedfs.edges.forest import LABEL, WINDOW, feature_table, read_feature
from threedfs.edges.training.picture import Picture, contour_pixels, cut_label

_EDGES = 63
_CHUNK = 8192  # rows that are sorted into bins at once


@dataclass(frozen=True)
class Samples:
    """What a tree is grown from.

    Attributes
    ----------
    bins : (F, N) uint8
        Features of the samples, each as the number of its `edges` that are not above it.
    edges : (F, 63) float32
        Ascending thresholds of each feature; they survive half precision.
    features : (F,) int32
        Rows of the table of features.
    labels : (N, 16, 16) uint8
    """

    bins: np.ndarray
    edges: np.ndarray
    features: np.ndarray
    labels: np.ndarray


def draw_samples(
    pictures: Sequence[Picture], per_picture: int, feature_share: float, rng: np.random.Generator
) -> Samples:
    """Draw windows, half of them with a contour in the middle, and measure a random share of the features.

    Parameters
    ----------
    pictures : sequence of Picture
    per_picture : int
        Windows of each; fewer where it has not so many of either kind.
    feature_share : float
        In (0, 1].
    rng : Generator
    """
    table = feature_table()
    features = np.sort(rng.choice(len(table), round(len(table) * feature_share), replace=False)).astype(np.int32)
    asked = table[features]
    # Half precision: the matrix of all features of all samples is what fills the memory.
    values = np.empty((len(pictures) * per_picture, len(features)), np.float16)
    labels = np.empty((len(values), LABEL, LABEL), np.uint8)
    count = 0
    for picture in pictures:
        places = _draw_places(picture, per_picture, rng)
        fine, coarse = compute_channels(picture.image)
        stop = count + len(places)
        measured = np.empty((len(places), len(features)), np.float32)
        _measure(fine, coarse, places, asked, measured)
        values[count:stop] = measured
        _cut_labels(picture.right, picture.down, places, labels[count:stop])
        count = stop
    values, labels = values[:count], labels[:count]
    bins, edges = _sort_into_bins(values, rng)
    return Samples(bins, edges, features, labels)


def _draw_places(picture, count, rng):
    """Draw the first pixels (row, column) of windows, in pixels of the channels; (N, 2) int32."""
    contour = contour_pixels(picture)
    distance = cv2.distanceTransform((~contour).astype(np.uint8), cv2.DIST_L2, 5)
    # The label's middle lies half a window from the first pixel.
    middle = distance[WINDOW::2, WINDOW::2][: contour.shape[0] // 2 - WINDOW + 1, : contour.shape[1] // 2 - WINDOW + 1]
    places = []
    for wanted in (middle < LABEL / 2, middle >= LABEL / 2):
        candidates = np.argwhere(wanted)
        chosen = rng.permutation(len(candidates))[: count // 2]
        places.append(candidates[chosen])
    return np.concatenate(places).astype(np.int32)


@njit(cache=True)
def _measure(fine, coarse, places, table, values):
    for n in range(len(places)):
        for f in range(len(table)):
            values[n, f] = read_feature(fine, coarse, places[n, 0], places[n, 1], table[f])


@njit(cache=True)
def _cut_labels(right, down, places, labels):
    margin = WINDOW - LABEL // 2
    for n in range(len(places)):
        cut_label(right, down, 2 * places[n, 0] + margin, 2 * places[n, 1] + margin, labels[n])


def _sort_into_bins(values, rng):
    """Return bins (F, N) and edges (F, 63) at quantiles of a sample of the rows."""
    some = values[np.sort(rng.choice(len(values), min(len(values), 6000), replace=False))].astype(np.float32)
    some.sort(axis=0)
    rows = (np.arange(1, _EDGES + 1) / (_EDGES + 1) * len(some)).astype(int)
    edges = np.ascontiguousarray(some[rows].astype(np.float16).astype(np.float32).T)
    bins = np.empty(values.shape[::-1], np.uint8)
    for start in range(0, len(values), _CHUNK):
        stop = start + _CHUNK
        _fill_bins(values[start:stop].astype(np.float32), edges, bins[:, start:stop])
    return bins, edges


@njit(cache=True)
def _fill_bins(values, edges, bins):
    for f in range(bins.shape[0]):
        for n in range(bins.shape[1]):
            bins[f, n] = np.searchsorted(edges[f], values[n, f], side="right")
