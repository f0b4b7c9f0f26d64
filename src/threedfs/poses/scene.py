"""Posed frames, the points they see, and where in the frames they see them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.colmap.model import Model
from threedfs.geometry.lens import Lens
from threedfs.types import Features, SparsePoints


@dataclass(frozen=True)
class Scene:
    """A reconstruction before it is scaled.

    Attributes
    ----------
    lenses, cam_from_world : mapping
        Lens and (4, 4) float64 pose by frame number.
    points : SparsePoints
        `track_frame` holds frame numbers.
    pixels : (M, 2) float64
        Where each observation of the points is in its frame.
    """

    lenses: Mapping[int, Lens]
    cam_from_world: Mapping[int, np.ndarray]
    points: SparsePoints
    pixels: np.ndarray


def number_frames(
    model: Model, lenses: Mapping[int, Lens], features: Sequence[Features], numbers: Sequence[int]
) -> Scene:
    """Return a model whose frames are counted among those with keypoints, with the numbers of all frames instead.

    Parameters
    ----------
    model : Model
    lenses : mapping
        By rank among the frames with keypoints.
    features : sequence of Features
        Of these frames.
    numbers : sequence of int
        Their numbers, ascending.
    """
    points = model.points
    pixels = np.zeros((len(points.track_frame), 2))
    for rank, frame in enumerate(features):
        here = points.track_frame == rank
        pixels[here] = frame.pixels[model.track_feature[here]]
    number = np.asarray(numbers)
    return Scene(
        {numbers[rank]: lenses[rank] for rank in model.cam_from_world},
        {numbers[rank]: pose for rank, pose in model.cam_from_world.items()},
        SparsePoints(points.xyz, points.rgb, points.error, points.track_point, number[points.track_frame]),
        pixels,
    )


def make_scene(
    lenses: Mapping[int, Lens],
    cam_from_world: Mapping[int, np.ndarray],
    xyz: np.ndarray,
    rgb: np.ndarray,
    track_point: np.ndarray,
    track_frame: np.ndarray,
    pixels: np.ndarray,
    least: int = 2,
) -> Scene:
    """Put points and observations together; observations by frames without a pose and short tracks are left out.

    Parameters
    ----------
    lenses, cam_from_world : mapping
        Lens and (4, 4) float64 pose by frame number.
    xyz, rgb : (N, 3)
    track_point, track_frame : (M,) int64
        Index of the point, and frame number, of each observation, in any order.
    pixels : (M, 2) float64
    least : int
        Observations that a point must have.
    """
    posed = np.isin(track_frame, list(cam_from_world))
    seen = np.bincount(track_point[posed], minlength=len(xyz))
    kept = np.flatnonzero(posed & (seen >= least)[track_point])
    kept = kept[np.lexsort((track_frame[kept], track_point[kept]))]
    used = np.flatnonzero(seen >= least)
    rank = np.searchsorted(used, track_point[kept])
    points = SparsePoints(xyz[used], rgb[used], np.zeros(len(used)), rank, track_frame[kept])
    scene = Scene(lenses, cam_from_world, points, pixels[kept])
    error = np.bincount(rank, observation_errors(scene), len(used)) / np.maximum(
        np.bincount(rank, minlength=len(used)), 1
    )
    return Scene(
        lenses,
        cam_from_world,
        SparsePoints(points.xyz, points.rgb, error, points.track_point, points.track_frame),
        scene.pixels,
    )


def observation_errors(scene: Scene) -> np.ndarray:
    """Return the reprojection error (M,) of each observation, pixels; infinite behind the camera."""
    errors = np.full(len(scene.pixels), np.inf)
    for frame, pose in scene.cam_from_world.items():
        here = np.flatnonzero(scene.points.track_frame == frame)
        in_camera = scene.points.xyz[scene.points.track_point[here]] @ pose[:3, :3].T + pose[:3, 3]
        front = in_camera[:, 2] > 0
        here, in_camera = here[front], in_camera[front]
        shown = scene.lenses[frame].denormalise(in_camera[:, :2] / in_camera[:, 2:])
        error = np.linalg.norm(shown - scene.pixels[here], axis=1)
        errors[here] = np.where(np.isfinite(error), error, np.inf)
    return errors
