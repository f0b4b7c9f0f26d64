"""Which frames are matched with which."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from threedfs.geometry.rigid import camera_centres

Pairs = list[tuple[int, int]]


def sequential_pairs(frames: int, overlap: int) -> Pairs:
    """Pair every frame with the `overlap` next ones.

    Examples
    --------
    >>> sequential_pairs(4, 2)
    [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)]
    """
    return [(first, second) for first in range(frames) for second in range(first + 1, min(first + overlap + 1, frames))]


def exhaustive_pairs(frames: int) -> Pairs:
    """Pair every frame with every other."""
    return sequential_pairs(frames, frames)


def overlapping_pairs(cam_from_world: Mapping[int, np.ndarray], *, max_angle: float, most: int) -> Pairs:
    """Pair posed frames that look at the scene from similar sides.

    Parameters
    ----------
    cam_from_world : mapping of int to (4, 4) float64
    max_angle : float
        Largest angle between their optical axes, radians.
    most : int
        Each frame is paired with at most so many nearest ones (by centre, then those that chose it).
    """
    frames = sorted(cam_from_world)
    poses = np.array([cam_from_world[frame] for frame in frames])
    axes = poses[:, 2, :3]
    centres = camera_centres(poses)
    alike = axes @ axes.T >= np.cos(max_angle)
    np.fill_diagonal(alike, False)
    distance = np.where(alike, np.linalg.norm(centres[:, None] - centres, axis=-1), np.inf)
    pairs = set()
    for row, order in enumerate(np.argsort(distance, axis=1, kind="stable")[:, :most]):
        for column in order[np.isfinite(distance[row, order])]:
            pairs.add((frames[min(row, column)], frames[max(row, column)]))
    return sorted(pairs)
