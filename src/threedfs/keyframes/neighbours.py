"""The frames that a keyframe is matched against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.keyframes.visibility import Visibility

_LEAST_ANGLE = 0.01
"""Degrees below which cameras stand at the same place: depth moves no pixel by more than a fraction."""


@dataclass(frozen=True)
class NeighbourRule:
    """What makes a good neighbour; see `KeyframesParams` for each value. Angles in degrees."""

    count: int
    min_count: int
    min_angle: float
    max_angle: float
    widest_angle: float
    min_overlap: float
    min_shared: int


def measure_pairs(visibility: Visibility, keyframe: int) -> tuple[np.ndarray, np.ndarray]:
    """Measure how each frame sees what a keyframe sees.

    Returns
    -------
    overlap : (F,) float64
        Share of the keyframe's points that fall on the frame's image.
    angle : (F,) float64
        Median angle in degrees between the rays of those points to the two cameras, each point weighted by its
        squared inverse depth, so that a distant background does not hide how wide the baseline is for what is near;
        NaN without common points.
    """
    seen = visibility.seen[keyframe]
    xyz = visibility.xyz[seen]
    in_view = visibility.in_view[:, seen]
    overlap = in_view.mean(axis=1) if len(xyz) else np.zeros(len(in_view))
    nearness = visibility.depth[keyframe, seen] ** -2.0
    to_keyframe = _unit(visibility.centres[keyframe] - xyz)
    angle = np.full(len(in_view), np.nan)
    for frame, common in enumerate(in_view):
        if common.any():
            to_frame = _unit(visibility.centres[frame] - xyz[common])
            cosine = np.clip((to_keyframe[common] * to_frame).sum(axis=1), -1, 1)
            angle[frame] = np.degrees(_weighted_median(np.arccos(cosine), nearness[common]))
    return overlap, angle


def choose_neighbours(visibility: Visibility, keyframe: int, rule: NeighbourRule) -> np.ndarray:
    """Choose the neighbours of a keyframe, one after another, by overlap, angle and distance to those chosen.

    A frame is worth its overlap, less where its triangulation angle lies outside min_angle .. max_angle, and less
    the nearer it is to a neighbour already chosen; so they spread over both sides of a video's path, and over the
    sphere of a photo set. Frames beyond widest_angle, under min_overlap or under min_shared serve only to reach
    min_count. A frame from the same place is worth nothing.

    Returns
    -------
    (N,) int64
        Frame numbers, best first; none where no frame sees the keyframe's points from another place.
    """
    overlap, angle = measure_pairs(visibility, keyframe)
    angle = np.where(np.isfinite(angle), angle, 180.0)
    worth = (
        overlap * np.minimum(angle / rule.min_angle, 1) * np.minimum(rule.max_angle / np.maximum(angle, 1e-9), 1) ** 2
    )
    worth[angle < _LEAST_ANGLE] = 0
    worth[keyframe] = 0
    shared = visibility.seen[:, visibility.seen[keyframe]].sum(axis=1)
    fit = (angle <= rule.widest_angle) & (overlap >= rule.min_overlap) & (shared >= rule.min_shared)
    # Offsets of the centres on the sphere of angles: along the baseline, as long as the triangulation angle.
    baseline = visibility.centres - visibility.centres[keyframe]
    offset = baseline * (angle / np.maximum(np.linalg.norm(baseline, axis=1), 1e-12))[:, None]
    separation = 2 * rule.max_angle / rule.count

    chosen: list[int] = []
    spread = np.ones(len(worth))
    while len(chosen) < rule.count:
        value = worth * spread * fit
        if value.max() <= 0 and len(chosen) < rule.min_count:
            value = worth * spread
        best = int(np.argmax(value))
        if value[best] <= 0:
            break
        chosen.append(best)
        apart = np.linalg.norm(offset - offset[best], axis=1)
        spread = np.minimum(spread, np.clip(apart / separation, 0, 1))
    return np.array(chosen, np.int64)


def _weighted_median(values, weights):
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[order])
    return values[order[np.searchsorted(below, below[-1] / 2)]]


def _unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
