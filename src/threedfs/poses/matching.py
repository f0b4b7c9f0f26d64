"""Matching of descriptors: mutual nearest neighbours that are clearly nearer than the second nearest."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numba import njit

_LENGTH2 = 512.0**2  # of a SIFT descriptor


def match_pairs(
    descriptors: Sequence[np.ndarray],
    pairs: Sequence[tuple[int, int]],
    *,
    max_ratio: float,
    max_angle: float,
    min_matches: int,
    threads: int,
) -> dict[tuple[int, int], np.ndarray]:
    """Match the frames of each pair.

    Parameters
    ----------
    descriptors : sequence of (N, 128) uint8
        Of every frame.
    pairs : sequence of (int, int)
        Frame numbers, first < second.
    max_ratio : float
        Largest ratio of the angle to the nearest descriptor over that to the second nearest.
    max_angle : float
        Largest angle between matching descriptors, radians.
    min_matches : int
        Pairs with fewer are left out.
    threads : int

    Returns
    -------
    dict
        (M, 2) uint32 keypoint indices by pair, ascending in the first column.
    """
    # Products of bytes summed in float32 stay below 2^24, so they are exact and independent of summation order.
    exact = [block.astype(np.float32) for block in descriptors]

    def match(pair: tuple[int, int]) -> np.ndarray:
        first, second = exact[pair[0]], exact[pair[1]]
        if min(len(first), len(second)) < 2:
            return np.zeros((0, 2), np.uint32)
        return _mutual_nearest(first @ second.T, max_ratio, max_angle)

    with ThreadPoolExecutor(threads) as pool:
        found = pool.map(match, pairs)
        return {pair: matches for pair, matches in zip(pairs, found, strict=True) if len(matches) >= min_matches}


@njit(nogil=True, cache=True)
def _mutual_nearest(similarity, max_ratio, max_angle):
    rows, columns = similarity.shape
    row_best = np.full(rows, -1, np.int64)
    column_best = np.full(columns, -1, np.int64)
    row_value, row_second = np.full(rows, -1, np.float32), np.full(rows, -1, np.float32)
    column_value, column_second = np.full(columns, -1, np.float32), np.full(columns, -1, np.float32)
    for i in range(rows):
        for j in range(columns):
            value = similarity[i, j]
            if value > row_value[i]:
                row_second[i] = row_value[i]
                row_value[i] = value
                row_best[i] = j
            elif value > row_second[i]:
                row_second[i] = value
            if value > column_value[j]:
                column_second[j] = column_value[j]
                column_value[j] = value
                column_best[j] = i
            elif value > column_second[j]:
                column_second[j] = value
    matches = np.empty((min(rows, columns), 2), np.uint32)
    count = 0
    for i in range(rows):
        j = row_best[i]
        if column_best[j] != i:
            continue
        angle = np.arccos(min(row_value[i] / _LENGTH2, 1.0))
        rival = np.arccos(min(max(row_second[i], column_second[j]) / _LENGTH2, 1.0))
        if angle <= max_angle and angle < max_ratio * rival:
            matches[count, 0] = i
            matches[count, 1] = j
            count += 1
    return matches[:count].copy()
