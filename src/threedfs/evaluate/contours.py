"""Scores of contours against human ones: precision and recall over thresholds, as the BSDS benchmark defines them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

TOLERANCE = 0.0075
"""Largest distance of matched pixels, in diagonals of the image (Martin, Fowlkes and Malik 2004)."""


@dataclass(frozen=True)
class ContourCounts:
    """Matched pixels of one image at K thresholds, all (K,) int64.

    Attributes
    ----------
    found : pixels of the detector's contours
    right : those of them that match at least one truth
    wanted : pixels of all truths together
    recalled : those of them that are matched
    """

    found: np.ndarray
    right: np.ndarray
    wanted: np.ndarray
    recalled: np.ndarray


@dataclass(frozen=True)
class ContourScores:
    """F-measures of a set of images: at the one threshold best for all, and at the best of each."""

    ods: float
    ois: float
    threshold: float
    precision: float
    recall: float


def match_contours(first: np.ndarray, second: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Match pixels of two thin contours one to one, as many as possible.

    Parameters
    ----------
    first, second : (H, W) bool
    distance : float
        Between matched pixels at most, pixels.

    Returns
    -------
    first_matched, second_matched : (H, W) bool
    """
    matched = np.zeros(first.shape, bool), np.zeros(first.shape, bool)
    pixels = np.argwhere(first)
    number = np.full(second.shape, -1)
    number[second] = np.arange(second.sum())
    if not len(pixels) or not second.any():
        return matched
    # Near pairs come first, so that most pixels find their partner at once.
    reach = int(distance)
    offsets = np.stack(np.meshgrid(*(np.arange(-reach, reach + 1),) * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    offsets = offsets[(offsets**2).sum(1) <= distance**2]
    offsets = offsets[np.argsort((offsets**2).sum(1), kind="stable")]
    padded = np.pad(number, reach, constant_values=-1)
    near = padded[pixels[:, :1] + offsets[:, 0] + reach, pixels[:, 1:] + offsets[:, 1] + reach]
    has = near >= 0
    starts = np.concatenate([[0], np.cumsum(has.sum(1))])
    partner = _match(starts, near[has], int(second.sum()))
    hit = partner >= 0
    matched[0][tuple(pixels[hit].T)] = True
    matched[1][tuple(np.argwhere(second)[partner[hit]].T)] = True
    return matched


@njit(cache=True)
def _match(starts, neighbours, count):
    """Return the partner (N,) of each vertex in a largest bipartite matching, -1 without one.

    Paths are sought from one vertex after another. What a search without success has reached can lie on no later
    path, so it stays marked.
    """
    size = len(starts) - 1
    partner, holder = np.full(size, -1), np.full(count, -1)
    reached, came_from = np.zeros(count, np.bool_), np.empty(count, np.int64)
    waiting, marked = np.empty(size + 1, np.int64), np.empty(count, np.int64)
    for start in range(size):
        waiting[0] = start
        head, tail, marks, end = 0, 1, 0, -1
        while head < tail and end < 0:
            here = waiting[head]
            head += 1
            for k in range(starts[here], starts[here + 1]):
                other = neighbours[k]
                if reached[other]:
                    continue
                reached[other], came_from[other] = True, here
                marked[marks] = other
                marks += 1
                if holder[other] < 0:
                    end = other
                    break
                waiting[tail] = holder[other]
                tail += 1
        if end < 0:
            continue
        for k in range(marks):
            reached[marked[k]] = False
        while end >= 0:
            here = came_from[end]
            holder[end] = here
            end, partner[here] = partner[here], end
    return partner


def count_matches(strength: np.ndarray, truths: Sequence[np.ndarray], thresholds: Sequence[float]) -> ContourCounts:
    """Match thin contours, cut at each threshold, with each truth of one image.

    Parameters
    ----------
    strength : (H, W) float
        Thin: 0 off the contours.
    truths : sequence of (H, W) bool
        One by each annotator.
    thresholds : (K,) float
        Pixels of at least that strength are contours.
    """
    distance = TOLERANCE * float(np.hypot(*strength.shape))
    rows = []
    for threshold in thresholds:
        found = strength >= threshold
        right, recalled = np.zeros(found.shape, bool), 0
        for truth in truths:
            of_found, of_truth = match_contours(found, truth, distance)
            right |= of_found
            recalled += int(of_truth.sum())
        rows.append((found.sum(), right.sum(), sum(int(truth.sum()) for truth in truths), recalled))
    return ContourCounts(*np.array(rows, np.int64).T)


def score_contours(counts: Sequence[ContourCounts], thresholds: Sequence[float]) -> ContourScores:
    """Combine the counts of images into ODS and OIS.

    Parameters
    ----------
    counts : sequence of ContourCounts
    thresholds : (K,) float
        At which they were counted.
    """
    table = np.stack([[one.found, one.right, one.wanted, one.recalled] for one in counts])  # (images, 4, K)
    whole = _f_measure(table.sum(0))
    best = int(whole.argmax())
    # OIS: each image at its own best threshold, then all counted together.
    own = np.stack([one[:, _f_measure(one).argmax()] for one in table]).sum(0)
    found, right, wanted, recalled = table.sum(0)[:, best]
    return ContourScores(
        ods=float(whole[best]),
        ois=float(_f_measure(own[:, None])[0]),
        threshold=float(thresholds[best]),
        precision=float(right / max(found, 1)),
        recall=float(recalled / max(wanted, 1)),
    )


def _f_measure(table):
    """Harmonic mean of precision and recall of (4, K) counts."""
    found, right, wanted, recalled = table
    precision, recall = right / np.maximum(found, 1), recalled / np.maximum(wanted, 1)
    return 2 * precision * recall / np.maximum(precision + recall, 1e-12)
