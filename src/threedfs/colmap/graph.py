"""The match graph: which keypoints of which frames show the same point, in a COLMAP database."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pycolmap

from threedfs.colmap.lens import colmap_from_px
from threedfs.types import Features

Matches = Mapping[tuple[int, int], np.ndarray]
"""(M, 2) uint32 keypoint indices by pair of frame numbers (first < second)."""


def image_id(frame: int) -> int:
    """Return COLMAP's id of a frame number: ids start at 1."""
    return frame + 1


def frame_number(identity: int) -> int:
    """Return the frame number of a COLMAP image id."""
    return identity - 1


def write_graph(
    path: Path,
    cameras: Sequence[pycolmap.Camera],
    features: Sequence[Features],
    matches: Matches,
    *,
    verified: bool,
) -> None:
    """Write a database of cameras, frames, keypoints and matches.

    Parameters
    ----------
    path : Path
        A new file.
    cameras : sequence of pycolmap.Camera
        One that all frames share, or one a frame.
    features : sequence of Features
    matches : mapping
        By pair of frame numbers.
    verified : bool
        Write them as geometrically verified.
    """
    with pycolmap.Database.open(path) as database, pycolmap.DatabaseTransaction(database):
        for camera in cameras:
            database.write_camera(camera, use_camera_id=True)
            rig = pycolmap.Rig(rig_id=camera.camera_id)
            rig.add_ref_sensor(camera.sensor_id)
            database.write_rig(rig, use_rig_id=True)
        for number, frame in enumerate(features):
            camera_id = cameras[min(number, len(cameras) - 1)].camera_id
            _write_frame(database, image_id(number), camera_id, colmap_from_px(frame.pixels))
        for (first, second), pairs in sorted(matches.items()):
            database.write_matches(image_id(first), image_id(second), pairs)
            if verified:
                geometry = pycolmap.TwoViewGeometry(inlier_matches=pairs)
                geometry.config = pycolmap.TwoViewGeometryConfiguration.CALIBRATED.value
                database.write_two_view_geometry(image_id(first), image_id(second), geometry)


def _write_frame(database: pycolmap.Database, identity: int, camera_id: int, keypoints: np.ndarray) -> None:
    image = pycolmap.Image(name=f"{frame_number(identity):06d}", camera_id=camera_id, image_id=identity)
    database.write_image(image, use_image_id=True)
    frame = pycolmap.Frame(frame_id=identity, rig_id=camera_id)
    frame.add_data_id(image.data_id)
    database.write_frame(frame, use_frame_id=True)
    database.write_keypoints(identity, np.ascontiguousarray(keypoints, np.float32))
