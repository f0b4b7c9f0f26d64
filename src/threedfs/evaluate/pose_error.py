"""Error of camera poses against true ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist

from threedfs.errors import UserError
from threedfs.geometry.rigid import camera_centres, rotation_angle
from threedfs.geometry.similarity import Similarity, align


@dataclass(frozen=True)
class PoseError:
    """Error of each of N poses.

    Attributes
    ----------
    centre : (N,) float64
        Distance of the camera centres after alignment, as a share of the true path's extent: the largest distance
        between two of its centres.
    rotation : (N,) float64
        Angle between the camera axes, in radians.
    """

    centre: np.ndarray
    rotation: np.ndarray


def align_poses(poses: Sequence[np.ndarray], truth: Sequence[np.ndarray]) -> Similarity:
    """Fit the similarity truth_from_world that brings the camera centres onto the true ones.

    Parameters
    ----------
    poses, truth : (N, 4, 4) float64
        cam_from_world and cam_from_truth of the same cameras.

    Raises
    ------
    UserError
        If fewer than 3 cameras are common, or the centres lie on one line: neither fixes a similarity.
    """
    if len(poses) < 3:
        raise UserError(
            f"true cameras: expected at least 3 that belong to posed frames, got {len(poses)}; name true cameras after "
            "their frames (video frame number or photo name)."
        )
    source, target = camera_centres(poses), camera_centres(truth)
    for centres, whose in ((source, "estimated"), (target, "true")):
        spread = np.linalg.svd(centres - centres.mean(0), compute_uv=False)
        if not spread[1] > 1e-6 * spread[0]:
            raise UserError(
                f"true cameras: expected camera centres that do not lie on one line, got {whose} ones that do; "
                "scores against true cameras need a path that turns."
            )
    return align(source, target)


def measure_poses(poses: Sequence[np.ndarray], truth: Sequence[np.ndarray], truth_from_world: Similarity) -> PoseError:
    """Measure the error of poses (N, 4, 4) against true ones after alignment."""
    aligned = np.stack([truth_from_world.apply_to_pose(pose) for pose in poses])
    true_centres = camera_centres(truth)
    distance = np.linalg.norm(camera_centres(aligned) - true_centres, axis=1)
    relative = aligned[:, :3, :3] @ np.stack(truth)[:, :3, :3].transpose(0, 2, 1)
    return PoseError(distance / pdist(true_centres).max(), rotation_angle(relative))
