"""Figures of a reconstruction."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from threedfs.poses.tracks import triangulation_angles
from threedfs.types import SparsePoints


def measure_points(points: SparsePoints, cam_from_world: Mapping[int, np.ndarray]) -> dict[str, float]:
    """Return how well points are seen.

    Returns
    -------
    dict
        `points` and `observations` (counts), `reprojection_error` (mean over observations, pixels),
        `track_length` (mean, frames), `triangulation_angle` (median over points of the widest angle, degrees).
    """
    count = len(points.xyz)
    if count == 0:
        return {
            "points": 0,
            "observations": 0,
            "reprojection_error": 0.0,
            "track_length": 0.0,
            "triangulation_angle": 0.0,
        }
    length = np.bincount(points.track_point, minlength=count)
    return {
        "points": count,
        "observations": int(length.sum()),
        "reprojection_error": float((points.error * length).sum() / length.sum()),
        "track_length": float(length.mean()),
        "triangulation_angle": float(np.degrees(np.median(triangulation_angles(points, cam_from_world)))),
    }
