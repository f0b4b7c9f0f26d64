"""Poses of frames between those that were mapped."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import cv2
import numpy as np

from threedfs.colmap.resection import estimate_pose
from threedfs.poses.scene import Scene

_WINDOW = (21, 21)
_LEVELS = 3  # of half the size each: motion of some tens of pixels is followed


@dataclass(frozen=True)
class ResectionRule:
    """How frames between mapped ones get their pose.

    Attributes
    ----------
    followed_points : int
        Points followed from each of the neighbours, those that most frames see.
    max_error : float
        Largest reprojection error of a point that supports a pose, pixels.
    min_inliers, followed_share : int, float
        Least number of such points, and least share of the followed ones.
    """

    followed_points: int
    max_error: float
    min_inliers: int
    followed_share: float


def resect_frames(
    scene: Scene, images: np.ndarray, mapped: Sequence[int], rule: ResectionRule, *, seed: int, threads: int
) -> dict[int, np.ndarray]:
    """Find the poses of frames between those that were mapped, from points followed by optical flow.

    Parameters
    ----------
    scene : Scene
    images : (F, H, W) uint8
        Grey images of all frames of a video.
    mapped : sequence of int
        Numbers of the frames that took part in mapping, ascending; those without a pose get none here either.
    rule : ResectionRule
    seed : int
        Of the random samples.
    threads : int
        Changes no result.

    Returns
    -------
    dict
        (4, 4) float64 cam_from_world by frame number; frames without enough support are absent.
    """
    lens = next(iter(scene.lenses.values()))
    left_out = np.setdiff1d(np.arange(len(images)), mapped).tolist()
    length = np.bincount(scene.points.track_point, minlength=len(scene.points.xyz))

    def follow(frame: int) -> tuple[np.ndarray, np.ndarray]:
        place = np.searchsorted(mapped, frame)
        near = [other for other in mapped[max(place - 1, 0) : place + 1] if other in scene.cam_from_world]
        found = [_follow_points(scene, length, images, other, frame, rule.followed_points) for other in near]
        empty = (np.zeros((0, 2)), np.zeros((0, 3)))
        pixels, xyz = (np.concatenate(parts) for parts in zip(empty, *found, strict=True))
        return pixels, xyz

    with ThreadPoolExecutor(threads) as pool:
        followed = list(pool.map(follow, left_out))
    poses = {}
    for frame, (pixels, xyz) in zip(left_out, followed, strict=True):
        if len(xyz) < rule.min_inliers:
            continue
        solved = estimate_pose(pixels, xyz, lens, max_error=rule.max_error, seed=seed)
        if solved is not None and solved[1].sum() >= max(rule.min_inliers, rule.followed_share * len(xyz)):
            poses[frame] = solved[0]
    return poses


def _follow_points(scene, length, images, source, target, most):
    """Follow points that one frame sees into another; return their pixels (N, 2) there, and the points (N, 3)."""
    here = np.flatnonzero(scene.points.track_frame == source)
    here = here[np.argsort(-length[scene.points.track_point[here]], kind="stable")[:most]]
    if len(here) == 0:
        return np.zeros((0, 2)), np.zeros((0, 3))
    start = scene.pixels[here].astype(np.float32)
    pixels, status, _ = cv2.calcOpticalFlowPyrLK(
        images[source], images[target], start, None, winSize=_WINDOW, maxLevel=_LEVELS
    )
    found = status[:, 0] > 0
    return pixels[found].astype(np.float64), scene.points.xyz[scene.points.track_point[here[found]]]
