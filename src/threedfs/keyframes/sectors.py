"""Viewing sectors: stretches of the camera path that one keyframe stands for (LSD-SLAM's criterion)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from threedfs.keyframes.visibility import Visibility

_FINER = 0.85
"""From one threshold to the next; the score grows with the distance squared, so sectors become 8 % shorter."""


def score_frames(visibility: Visibility, distance_weight: float, usage_weight: float) -> np.ndarray:
    """Score how much each frame adds to each possible last keyframe.

    distance_weight |t * mean inverse depth|^2 + usage_weight (1 - usage)^2, with t the distance of the camera
    centres, the mean over the keyframe's points, and usage the share of them still in view (Section 3.1).

    Returns
    -------
    (F, F) float64
        Row: the keyframe; column: the frame.

    References
    ----------
    Engel, Schoeps, Cremers, LSD-SLAM: Large-scale direct monocular SLAM, 2014, Section 3.3.
    """
    seen = visibility.seen.astype(np.float64)
    count = np.maximum(seen.sum(axis=1), 1)
    mean_inverse_depth = np.where(visibility.seen, 1 / visibility.depth, 0).sum(axis=1) / count
    usage = seen @ visibility.in_view.T.astype(np.float64) / count[:, None]
    distance = np.linalg.norm(visibility.centres[:, None] - visibility.centres[None], axis=-1)
    score = distance_weight * (distance * mean_inverse_depth[:, None]) ** 2 + usage_weight * (1 - usage) ** 2
    np.fill_diagonal(score, 0)  # a frame without points uses none, but adds nothing to itself either
    return score


def split_sequence(score: np.ndarray, threshold: float) -> np.ndarray:
    """Split the frames of a video where the score against the sector's first frame passes the threshold.

    Parameters
    ----------
    score : (F, F) float64
        As `score_frames` gives it.
    threshold : float

    Returns
    -------
    (F,) int64
        Sector of each frame, ascending from 0.

    Examples
    --------
    >>> split_sequence(np.abs(np.subtract.outer(range(5), range(5))), 1)
    array([0, 0, 1, 1, 2])
    """
    sector = np.zeros(len(score), np.int64)
    first = 0
    for frame in range(1, len(score)):
        starts = score[first, frame] > threshold
        sector[frame] = sector[frame - 1] + starts
        first = frame if starts else first
    return sector


def divide_finely_enough(
    divide: Callable[[np.ndarray, float], np.ndarray], score: np.ndarray, threshold: float, least: float, count: int
) -> np.ndarray:
    """Divide frames into sectors, and by lower thresholds while those are fewer than asked for.

    Parameters
    ----------
    divide : callable
        `split_sequence` or `cluster_photos`.
    score : (F, F) float64
        As `score_frames` gives it.
    threshold, least : float
        The first, and the lowest.
    count : int
        Sectors asked for.

    Returns
    -------
    (F,) int64
        Sector of each frame.

    Examples
    --------
    >>> score = np.abs(np.subtract.outer(range(6), range(6)))
    >>> divide_finely_enough(split_sequence, score, 2.0, 0.5, 3)
    array([0, 0, 1, 1, 2, 2])
    """
    sector = divide(score, threshold)
    while len(np.unique(sector)) < count and threshold > least:
        threshold = max(threshold * _FINER, least)
        sector = divide(score, threshold)
    return sector


def cluster_photos(score: np.ndarray, threshold: float) -> np.ndarray:
    """Cluster unordered photos: each next centre is the photo that adds most, until none passes the threshold.

    Parameters
    ----------
    score : (F, F) float64
        As `score_frames` gives it.
    threshold : float

    Returns
    -------
    (F,) int64
        Sector of each frame, that of the centre to which it adds least.

    Examples
    --------
    >>> cluster_photos(np.abs(np.subtract.outer(range(5), range(5))), 1)
    array([0, 0, 2, 1, 1])
    """
    centres = [0]
    while True:
        added = score[centres].min(axis=0)
        added[centres] = 0
        if added.max() <= threshold:
            return score[centres].argmin(axis=0)
        centres.append(int(added.argmax()))
