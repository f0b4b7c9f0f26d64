"""Tracks: how points are seen, and which points are good enough to build on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numba import njit

from threedfs.poses.normalise import observed_depths
from threedfs.types import SparsePoints


def triangulation_angles(points: SparsePoints, cam_from_world: Mapping[int, np.ndarray]) -> np.ndarray:
    """Return for each point (N,) the largest angle between two rays that see it, radians."""
    centres = np.zeros((max(cam_from_world, default=-1) + 1, 3))
    for frame, pose in cam_from_world.items():
        centres[frame] = -pose[:3, :3].T @ pose[:3, 3]
    rays = centres[points.track_frame] - points.xyz[points.track_point]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    return _widest_angles(rays, np.searchsorted(points.track_point, np.arange(len(points.xyz) + 1)))


@njit(cache=True)
def _widest_angles(rays, starts):
    angles = np.zeros(len(starts) - 1)
    for point in range(len(angles)):
        least = 1.0
        for i in range(starts[point], starts[point + 1]):
            for j in range(starts[point], i):
                least = min(least, rays[i, 0] * rays[j, 0] + rays[i, 1] * rays[j, 1] + rays[i, 2] * rays[j, 2])
        angles[point] = np.arccos(max(least, -1.0))
    return angles


def good_points(
    points: SparsePoints,
    cam_from_world: Mapping[int, np.ndarray],
    *,
    max_error: float,
    min_angle: float,
    min_track: int,
) -> np.ndarray:
    """Say which points (N,) bool are seen well: in front, with small error, by enough frames, from apart.

    Parameters
    ----------
    points : SparsePoints
    cam_from_world : mapping of int to (4, 4) float64
    max_error : float
        Mean reprojection error, pixels.
    min_angle : float
        Largest angle between its rays, radians.
    min_track : int
        Frames that see it.
    """
    count = len(points.xyz)
    in_front = np.ones(count, bool)
    in_front[points.track_point[observed_depths(points, cam_from_world) <= 0]] = False
    length = np.bincount(points.track_point, minlength=count)
    wide = triangulation_angles(points, cam_from_world) >= min_angle
    return in_front & wide & (points.error <= max_error) & (length >= min_track)


def keep_well_seen(
    points: SparsePoints,
    cam_from_world: Mapping[int, np.ndarray],
    *,
    max_error: float,
    min_angle: float,
    min_track: int,
    min_points: int,
) -> SparsePoints:
    """Return the good points; with fewer than `min_points` also those that only two frames see (see `good_points`)."""
    for least in (min_track, 2):
        kept = good_points(points, cam_from_world, max_error=max_error, min_angle=min_angle, min_track=least)
        if kept.sum() >= min_points:
            break
    return keep_points(points, kept)


def keep_points(points: SparsePoints, kept: np.ndarray) -> SparsePoints:
    """Return only the points that are `kept` (N,) bool."""
    number = np.cumsum(kept) - 1
    seen = kept[points.track_point]
    return SparsePoints(
        points.xyz[kept],
        points.rgb[kept],
        points.error[kept],
        number[points.track_point[seen]],
        points.track_frame[seen],
    )
