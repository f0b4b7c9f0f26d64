"""Pose of one frame from points that are known."""

from __future__ import annotations

import numpy as np
import pycolmap

from threedfs.colmap.lens import colmap_from_px, make_colmap_camera
from threedfs.geometry.lens import Lens


def estimate_pose(
    pixels: np.ndarray, xyz: np.ndarray, lens: Lens, *, max_error: float, seed: int
) -> tuple[np.ndarray, np.ndarray] | None:
    """Estimate the pose of a frame that sees known points, some of them at wrong places.

    Parameters
    ----------
    pixels : (N, 2) float64
        Where the frame sees the points.
    xyz : (N, 3) float64
        The points, world.
    lens : Lens
    max_error : float
        Largest reprojection error of an inlier, pixels.
    seed : int
        Of the random samples.

    Returns
    -------
    tuple or None
        (4, 4) float64 cam_from_world and which points are inliers, (N,) bool.
    """
    options = pycolmap.AbsolutePoseEstimationOptions()
    options.ransac.max_error = max_error
    options.ransac.random_seed = seed
    found = pycolmap.estimate_and_refine_absolute_pose(
        colmap_from_px(pixels), xyz, make_colmap_camera(lens, 1), options
    )
    if found is None:
        return None
    pose = np.eye(4)
    pose[:3] = found["cam_from_world"].matrix()
    return pose, np.asarray(found["inlier_mask"], bool)
