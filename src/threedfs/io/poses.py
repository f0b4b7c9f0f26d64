"""Cameras of all frames, in scene units, with the distortion that undistortion removes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.geometry.similarity import Similarity
from threedfs.io.documents import read_document, write_document
from threedfs.io.schema import Schema
from threedfs.io.views import decode_view, encode_view
from threedfs.types import View

POSES = Schema("threedfs/poses/2", "poses")


@dataclass(frozen=True)
class Poses:
    """The result of pose estimation.

    Attributes
    ----------
    views : tuple of View
        Every posed frame, in the order of the frames; cameras are those of the undistorted images.
    unposed : tuple of str
        Working frames without a pose.
    distortion : tuple of float
        (k1, k2): a point at normalised (x, y) is seen at (x, y) (1 + k1 r^2 + k2 r^4) in the raw frame.
    scene_from_input : Similarity
        From the coordinates of the given cameras (or of the mapper) to scene units.
    quality : mapping of str to float
        The figures the gates looked at.
    """

    views: tuple[View, ...]
    unposed: tuple[str, ...]
    distortion: tuple[float, float]
    scene_from_input: Similarity
    quality: Mapping[str, float] = field(default_factory=dict)


def write_poses(path: Path, poses: Poses, header: Mapping[str, Any]) -> None:
    """Write poses.json."""
    similarity = poses.scene_from_input
    content = {
        "unit": "scene unit",
        "axes": "camera x right, y down, z forward; integer pixel coordinates are pixel centres",
        "views": [encode_view(view) for view in poses.views],
        "unposed": list(poses.unposed),
        "distortion": list(poses.distortion),
        "scene_from_input": {
            "scale": similarity.scale,
            "rotation": similarity.rotation.tolist(),
            "translation": similarity.translation.tolist(),
        },
        "quality": dict(poses.quality),
    }
    write_document(path, POSES, content, header)


def read_poses(path: Path) -> Poses:
    """Read poses.json."""
    content = read_document(path, POSES)
    similarity = content["scene_from_input"]
    return Poses(
        views=tuple(decode_view(view) for view in content["views"]),
        unposed=tuple(content["unposed"]),
        distortion=tuple(content["distortion"]),
        scene_from_input=Similarity(
            similarity["scale"], np.array(similarity["rotation"]), np.array(similarity["translation"])
        ),
        quality=content["quality"],
    )
