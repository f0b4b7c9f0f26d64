"""Keypoints of a made-up orbit: points on a cylinder and on a floor, projected into cameras that go around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.geometry.lens import Lens
from threedfs.geometry.rigid import look_at
from threedfs.types import Camera, Features

LENS = Lens(Camera(640, 480, 600.0, 600.0, 319.5, 239.5), k1=0.04)


@dataclass(frozen=True)
class Orbit:
    """An orbit with its truth."""

    features: list[Features]
    poses: dict[int, np.ndarray]
    xyz: np.ndarray
    seen: list[np.ndarray]

    @property
    def centres(self) -> np.ndarray:
        """(N, 3) camera centres."""
        return np.array([-pose[:3, :3].T @ pose[:3, 3] for pose in self.poses.values()])


def make_orbit(
    frames: int,
    turns: float,
    *,
    noise: float = 0.0,
    repeats: int = 1,
    object_points: int = 400,
    floor_points: int = 300,
) -> Orbit:
    """Project points into an orbit.

    Parameters
    ----------
    frames : int
    turns : float
    noise : float
        Standard deviation of keypoints, pixels.
    repeats : int
        The artwork of the cylinder repeats so often around it: the descriptors of its points do.
    object_points, floor_points : int
    """
    rng = np.random.default_rng(7)
    angle = rng.uniform(0, 2 * np.pi / repeats, object_points // repeats)
    height = rng.uniform(0, 1.2, object_points // repeats)
    angle = np.concatenate([angle + 2 * np.pi * k / repeats for k in range(repeats)])
    height = np.tile(height, repeats)
    outward = np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    body = 0.5 * outward + height[:, None] * [0, 0, 1]
    floor = np.column_stack([rng.uniform(-3, 3, (floor_points, 2)), rng.normal(0, 0.02, floor_points)])
    xyz = np.concatenate([body, floor])
    codes = np.concatenate([np.tile(np.arange(len(body) // repeats), repeats), len(body) + np.arange(floor_points)])
    descriptors = rng.integers(0, 256, (len(xyz), 128)) ** 2.0
    descriptors = np.rint(512 * descriptors / np.linalg.norm(descriptors, axis=1, keepdims=True)).clip(0, 255)

    features, poses, seen = [], {}, []
    for number, turn in enumerate(np.linspace(0, 2 * np.pi * turns, frames)):
        centre = np.array([3 * np.cos(turn), 3 * np.sin(turn), 1.6 + 0.3 * np.sin(1.7 * turn)])
        pose = look_at(centre, np.array([0, 0, 0.5]), np.array([0, 0, 1.0]))
        in_camera = xyz @ pose[:3, :3].T + pose[:3, 3]
        pixels = LENS.denormalise(in_camera[:, :2] / in_camera[:, 2:])
        facing = np.ones(len(xyz), bool)
        facing[: len(body)] = ((centre - body) * outward).sum(1) > 0.3
        shown = facing & (in_camera[:, 2] > 0.1) & np.all((pixels >= 0) & (pixels <= (639, 479)), axis=1)
        index = np.flatnonzero(shown)
        jitter = rng.normal(0, noise, (len(index), 2)) if noise else 0.0
        colors = np.full((len(index), 3), 100, np.uint8)
        features.append(Features(pixels[index] + jitter, descriptors[codes[index]].astype(np.uint8), colors))
        poses[number] = pose
        seen.append(index)
    return Orbit(features, poses, xyz, seen)


def true_matches(orbit: Orbit, pairs: list[tuple[int, int]]) -> dict[tuple[int, int], np.ndarray]:
    """Return the matches of each pair by the identity of the points."""
    found = {}
    for first, second in pairs:
        _, left, right = np.intersect1d(orbit.seen[first], orbit.seen[second], return_indices=True)
        found[first, second] = np.column_stack([left, right]).astype(np.uint32)
    return found
