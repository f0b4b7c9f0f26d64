"""One small value of every artifact, with its writer and reader."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from threedfs.geometry.rigid import look_at
from threedfs.geometry.similarity import Similarity
from threedfs.io import (
    appearance,
    calibration,
    consistency,
    depth_maps,
    features,
    frames,
    keyframes,
    located,
    metrics,
    points,
    poses,
    segmentation,
    superpixels,
    texture,
    volumes,
)
from threedfs.locate.find import Located
from threedfs.segment.appearance import Appearance
from threedfs.segment.color_model import ColorModel
from threedfs.segment.mixture import Mixture
from threedfs.segment.superpixels import Superpixels
from threedfs.segment.table import TablePicture
from threedfs.types import Box, Camera, Features, Keyframe, Plane, SparsePoints, Support, View, VoxelGrid

HEADER = {"parameters": {"size": 3, "names": ["a", "b"]}, "provenance": "0123"}
RANDOM = np.random.default_rng(5)
ASLANT = look_at(np.array([0.1, 0.3, -2.0]), np.zeros(3), np.array([0.0, -1, 0]))[:3, :3]
CAMERA = Camera(8, 6, 7.5, 7.25, 3.5, 2.5)


def picture(dtype=np.float32) -> np.ndarray:
    """An image of random numbers, one of them missing."""
    image = RANDOM.random((6, 8)).astype(dtype)
    image[2, 3] = np.nan
    return image


def view(name: str, x: float) -> View:
    """A view of the origin."""
    return View(name, CAMERA, look_at(np.array([x, 0.3, -2.0]), np.zeros(3), np.array([0.0, -1, 0])))


def make_mixture() -> Mixture:
    """A mixture of two colours."""
    return Mixture(np.array([0.25, 0.75]), RANDOM.normal(50, 10, (2, 3)), np.stack([np.eye(3), 2 * np.eye(3)]))


@dataclass(frozen=True)
class Artifact:
    """An artifact's file name, value, writer (path, value, header) and reader (path)."""

    name: str
    value: Any
    write: Callable[[Path, Any, dict], None]
    read: Callable[[Path], Any]


FRAMES = [frames.Frame(f"{i:06d}", i, i / 30, 1.0 + i, RANDOM.integers(0, 256, (6, 8, 3), np.uint8)) for i in range(3)]
ENTRIES = [
    Keyframe(view(name, x), (view("000009", 1.0), view("000003", -1.0)), 0.1, 3.0, within)
    for name, x, within in (("b", 0, (0.5, 1.5)), ("a", 1, None))
]
CONSISTENCY = consistency.ConsistencyMap(
    picture(), np.full((6, 8), np.inf, np.float32), *(RANDOM.integers(0, 9, (6, 8), np.uint8) for _ in range(3))
)

ARTIFACTS = [
    Artifact(
        "frames.zarr.zip",
        FRAMES,
        lambda path, value, header: frames.write_frames(path, value, header, ordered=True, source_shape=(12, 16)),
        frames.read_frames,
    ),
    Artifact(
        "calibration.json",
        calibration.Calibration(CAMERA, 0.01, -0.002, 0.15, 25),
        calibration.write_calibration,
        calibration.read_calibration,
    ),
    Artifact(
        "features.zarr.zip",
        {  # the middle frame shows nothing
            frame: Features(
                RANDOM.random((count, 2)), *(RANDOM.integers(0, 256, (count, n), np.uint8) for n in (128, 3))
            )
            for frame, count in ((0, 3), (2, 0), (4, 2))
        },
        features.write_features,
        features.read_features,
    ),
    Artifact(
        "poses.json",
        poses.Poses(
            (view("a", 0.1), view("b", 0.7)),
            ("c",),
            (0.02, -0.001),
            Similarity(2.5, np.eye(3), np.array([1.0, 2, 3])),
            {"turns": 1.5},
        ),
        poses.write_poses,
        poses.read_poses,
    ),
    Artifact(
        "points.zarr.zip",
        SparsePoints(
            RANDOM.random((4, 3)),
            RANDOM.integers(0, 256, (4, 3), np.uint8),
            RANDOM.random(4),
            np.array([0, 0, 1, 2, 3]),
            np.array([0, 1, 1, 0, 2]),
        ),
        points.write_points,
        points.read_points,
    ),
    Artifact("keyframes.json", ENTRIES, keyframes.write_keyframes, keyframes.read_keyframes),
    Artifact(
        "semidense.zarr.zip",
        depth_maps.Semidense(picture(), picture()),
        depth_maps.write_semidense,
        depth_maps.read_semidense,
    ),
    Artifact("edges.zarr.zip", picture(), depth_maps.write_edges, depth_maps.read_edges),
    Artifact(
        "depth.zarr.zip",
        depth_maps.DepthMap(picture(), picture(), picture()),
        depth_maps.write_depth_map,
        depth_maps.read_depth_map,
    ),
    Artifact(
        "consistency.zarr.zip",
        [("a", CONSISTENCY), ("b", CONSISTENCY)],
        consistency.write_consistency,
        consistency.read_consistency,
    ),
    Artifact(
        "volume.zarr.zip",
        volumes.Volume(
            VoxelGrid(np.array([0.5, -1, 2]), 0.1, (3, 4, 5), ASLANT),
            RANDOM.random((3, 4, 5)).astype(np.float32),
            RANDOM.integers(0, 9, (3, 4, 5), np.uint8),
        ),
        volumes.write_volume,
        volumes.read_volume,
    ),
    Artifact(
        "support.json",
        Support(Plane(np.array([0.0, -1, 0]), 0.25), Box(ASLANT, np.zeros(3), np.ones(3)), {"inliers": 0.5}),
        volumes.write_support,
        volumes.read_support,
    ),
    Artifact(
        "located.zarr.zip",
        Located(
            VoxelGrid(np.array([0.5, -1.0, 2.0]), 0.25, (3, 4, 5), ASLANT),
            Plane(np.array([0.0, -1, 0]), 0.25),
            RANDOM.random((3, 4, 5)) > 0.5,
            0.375,
            12,
            2,
        ),
        located.write_located,
        located.read_located,
    ),
    Artifact(
        "painted.json",
        texture.TextureRecord(["000000", "000002"], ["000001"], 17, 0.125),
        texture.write_texture,
        texture.read_texture,
    ),
    Artifact(
        "silhouettes.zarr.zip",
        {"000002": RANDOM.random((6, 8)) > 0.5, "000001": RANDOM.random((6, 8)) > 0.5},
        volumes.write_silhouettes,
        volumes.read_silhouettes,
    ),
    Artifact(
        "superpixels.zarr.zip",
        Superpixels(
            np.arange(48, dtype=np.int32).reshape(6, 8) // 24,
            np.array([[0, 1]], np.int32),
            np.array([16], np.int32),
            np.array([2.5], np.float32),
        ),
        superpixels.write_superpixels,
        superpixels.read_superpixels,
    ),
    Artifact(
        "appearance.zarr.zip",
        Appearance(
            ColorModel(make_mixture(), make_mixture()),
            TablePicture(
                RANDOM.random((4, 5, 3)).astype(np.float32),
                RANDOM.random((4, 5)).astype(np.float32),
                RANDOM.random((4, 5)) > 0.5,
                RANDOM.random((4, 5)) > 0.5,
                RANDOM.random((4, 3)),
            ),
        ),
        appearance.write_appearance,
        appearance.read_appearance,
    ),
    Artifact(
        "joint.zarr.zip",
        segmentation.Segmentation(
            {"000001": RANDOM.random((6, 8)) > 0.5, "000002": RANDOM.random((6, 8)) > 0.5},
            VoxelGrid(np.array([0.5, -1.0, 2.0]), 0.25, (3, 4, 5), ASLANT),
            RANDOM.integers(0, 3, (3, 4, 5), np.uint8),
            np.array([-1.5, -2.0]),
            np.array([40, 3], np.int64),
        ),
        segmentation.write_segmentation,
        segmentation.read_segmentation,
    ),
]


@pytest.fixture(params=ARTIFACTS, ids=lambda artifact: artifact.name)
def artifact(request) -> Artifact:
    """Each artifact that carries a schema."""
    return request.param


@pytest.fixture
def header() -> dict:
    """What a job puts into its artifacts."""
    return HEADER


@pytest.fixture
def figures() -> list[metrics.Metric]:
    """Rows of a table of metrics."""
    return [
        metrics.Metric("iou", 0.123456789, "1", "set", "mug", "fused_sdf", "000010"),
        metrics.Metric("seconds", 12.0, "s"),
    ]
