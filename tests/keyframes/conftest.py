"""A ring of cameras around points on a small sphere, all in view of all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from threedfs.geometry.rigid import look_at
from threedfs.keyframes.visibility import Visibility, find_visibility
from threedfs.types import Camera, SparsePoints, View


@dataclass(frozen=True)
class Ring:
    """Frames on a circle of radius 1, in order, with the points they see."""

    views: tuple[View, ...]
    points: SparsePoints
    valid: np.ndarray
    visibility: Visibility


@pytest.fixture(scope="session")
def make_ring():
    def make(count=72, turns=1.0, first_name=0):
        camera = Camera(160, 120, 150.0, 150.0, 79.5, 59.5)
        views = []
        for i in range(count):
            angle = 2 * np.pi * turns * i / count
            centre = np.array([np.cos(angle), -0.4, np.sin(angle)])
            pose = look_at(centre, np.zeros(3), np.array([0, -1.0, 0]))
            views.append(View(f"{first_name + 10 * i:06d}", camera, pose))
        xyz = np.random.default_rng(1).normal(size=(200, 3))
        xyz *= 0.1 / np.linalg.norm(xyz, axis=1, keepdims=True)
        points = SparsePoints(
            xyz=xyz,
            rgb=np.zeros((200, 3), np.uint8),
            error=np.zeros(200),
            track_point=np.repeat(np.arange(200), count),
            track_frame=np.tile(np.arange(count), 200),
        )
        valid = np.ones((120, 160), bool)
        return Ring(tuple(views), points, valid, find_visibility(views, points, valid))

    return make
