"""A reconstruction as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pycolmap

from threedfs.colmap.graph import frame_number
from threedfs.types import Features, SparsePoints


@dataclass(frozen=True)
class Model:
    """Poses of frames and the points that they see.

    Attributes
    ----------
    cam_from_world : mapping of int to (4, 4) float64
        By frame number; frames without a pose are absent.
    points : SparsePoints
        `track_frame` holds frame numbers.
    track_feature : (M,) int64
        Which keypoint of the frame each observation is.
    """

    cam_from_world: Mapping[int, np.ndarray]
    points: SparsePoints
    track_feature: np.ndarray


def read_model(reconstruction: pycolmap.Reconstruction, features: Sequence[Features]) -> Model:
    """Take the poses and points of a COLMAP reconstruction; colours are means over the keypoints of a track."""
    poses = {}
    for identity in sorted(reconstruction.reg_image_ids()):
        pose = np.eye(4)
        pose[:3] = reconstruction.image(identity).cam_from_world().matrix()
        poses[frame_number(identity)] = pose
    reconstruction.update_point_3d_errors()
    xyz, errors, tracks = [], [], []
    for number, identity in enumerate(sorted(reconstruction.point3D_ids())):
        point = reconstruction.point3D(identity)
        xyz.append(point.xyz)
        errors.append(point.error)
        seen = sorted((frame_number(element.image_id), element.point2D_idx) for element in point.track.elements)
        tracks.extend((number, frame, feature) for frame, feature in seen)
    track_point, track_frame, track_feature = np.array(tracks, np.int64).reshape(-1, 3).T.copy()
    points = SparsePoints(
        np.array(xyz, np.float64).reshape(-1, 3),
        _mean_colors(len(xyz), track_point, track_frame, track_feature, features),
        np.array(errors, np.float64),
        track_point,
        track_frame,
    )
    return Model(poses, points, track_feature)


def _mean_colors(count, track_point, track_frame, track_feature, features) -> np.ndarray:
    total, seen = np.zeros((count, 3)), np.zeros(count)
    for frame in np.unique(track_frame):
        here = track_frame == frame
        np.add.at(total, track_point[here], features[frame].colors[track_feature[here]].astype(np.float64))
        np.add.at(seen, track_point[here], 1)
    return np.rint(total / np.maximum(seen, 1)[:, None]).astype(np.uint8)
