"""Matches against the epipolar geometry of known poses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from threedfs.geometry.lens import Lens
from threedfs.geometry.rigid import invert


def epipolar_errors(second_from_first: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the Sampson distances (M,) of matches in undistorted normalised coordinates (M, 2).

    Parameters
    ----------
    second_from_first : (4, 4) float64
        Relative pose.
    first, second : (M, 2) float64
    """
    x, y, z = second_from_first[:3, 3]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    essential = cross @ second_from_first[:3, :3]
    first, second = (np.column_stack([points, np.ones(len(points))]) for points in (first, second))
    line_second, line_first = first @ essential.T, second @ essential
    residual = (second * line_second).sum(1)
    slope = (line_second[:, :2] ** 2).sum(1) + (line_first[:, :2] ** 2).sum(1)
    return np.abs(residual) / np.sqrt(np.maximum(slope, 1e-300))


def agreeing_matches(
    pixels: Sequence[np.ndarray],
    matches: Mapping[tuple[int, int], np.ndarray],
    lenses: Mapping[int, Lens],
    cam_from_world: Mapping[int, np.ndarray],
    *,
    max_error: float,
    min_matches: int,
) -> dict[tuple[int, int], np.ndarray]:
    """Keep matches near their epipolar lines.

    Parameters
    ----------
    pixels : sequence of (N, 2) float64
        Keypoints of every frame.
    matches : mapping
        (M, 2) uint32 by pair of frame numbers; both have a pose.
    lenses, cam_from_world : mapping
        Lens and (4, 4) float64 pose by frame number.
    max_error : float
        Pixels.
    min_matches : int
        Pairs left with fewer are dropped.
    """
    ideal = {frame: lenses[frame].normalise(pixels[frame]) for frame in cam_from_world}
    kept = {}
    for (first, second), pairs in matches.items():
        relative = cam_from_world[second] @ invert(cam_from_world[first])
        focal = (lenses[first].camera.fx + lenses[second].camera.fx) / 2
        errors = epipolar_errors(relative, ideal[first][pairs[:, 0]], ideal[second][pairs[:, 1]])
        near = pairs[errors * focal <= max_error]
        if len(near) >= min_matches:
            kept[first, second] = near
    return kept
