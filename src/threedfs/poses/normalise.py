"""The scale of the scene: mean inverse depth of its points is 1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from threedfs.geometry.similarity import Similarity
from threedfs.types import SparsePoints


def observed_depths(points: SparsePoints, cam_from_world: Mapping[int, np.ndarray]) -> np.ndarray:
    """Return the camera-frame depth (M,) of every observation."""
    depth = np.empty(len(points.track_point))
    for frame in np.unique(points.track_frame):
        here = points.track_frame == frame
        pose = cam_from_world[int(frame)]
        depth[here] = points.xyz[points.track_point[here]] @ pose[2, :3] + pose[2, 3]
    return depth


def find_scale(points: SparsePoints, cam_from_world: Mapping[int, np.ndarray]) -> Similarity:
    """Find the similarity after which the mean inverse depth, over points and the frames that see them, is 1.

    It scales about the origin and neither rotates nor shifts: given cameras stay comparable with their file.
    """
    scale = float(np.mean(1 / observed_depths(points, cam_from_world)))
    return Similarity(scale, np.eye(3), np.zeros(3))


def rescale_points(points: SparsePoints, scene_from_input: Similarity, posed: Sequence[int]) -> SparsePoints:
    """Return the points in scene units, their frames numbered by position in `posed` instead of among all frames."""
    position = np.full(max(posed) + 1, -1, np.int64)
    position[np.asarray(posed)] = np.arange(len(posed))
    return replace(points, xyz=scene_from_input.apply(points.xyz), track_frame=position[points.track_frame])
