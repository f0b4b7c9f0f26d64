"""Rigid transforms as (4, 4) matrices named to_from, so that adjacent names cancel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def make_transform(rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Assemble a (4, 4) float64 transform from a (3, 3) rotation and a (3,) translation."""
    transform = np.eye(4)
    transform[:3, :3] = rotation
    transform[:3, 3] = translation
    return transform


def invert(b_from_a: np.ndarray) -> np.ndarray:
    """Return a_from_b for a rigid (4, 4) transform.

    Examples
    --------
    >>> t = make_transform(np.eye(3), [1, 2, 3])
    >>> bool((invert(t) @ t == np.eye(4)).all())
    True
    """
    rotation = b_from_a[:3, :3].T
    return make_transform(rotation, -rotation @ b_from_a[:3, 3])


def apply(b_from_a: np.ndarray, points_a: np.ndarray) -> np.ndarray:
    """Map points (..., 3) by a (4, 4) affine transform."""
    return points_a @ b_from_a[:3, :3].T + b_from_a[:3, 3]


def camera_centres(cam_from_world: Sequence[np.ndarray]) -> np.ndarray:
    """Return the centres (N, 3), world, of poses (N, 4, 4)."""
    cam_from_world = np.reshape(cam_from_world, (-1, 4, 4))
    return -np.einsum("nij,ni->nj", cam_from_world[:, :3, :3], cam_from_world[:, :3, 3])


def rotation_angle(rotation: np.ndarray) -> np.ndarray:
    """Angle of (..., 3, 3) rotations, in radians, in [0, pi]."""
    cosine = (np.trace(rotation, axis1=-2, axis2=-1) - 1) / 2
    return np.arccos(np.clip(cosine, -1, 1))


def look_at(centre: np.ndarray, target: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Return cam_from_world of a camera at `centre` whose z axis points at `target` and whose -y is near `up`."""
    forward = np.asarray(target, float) - centre
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, up)
    right = right / np.linalg.norm(right)
    rotation = np.stack([right, np.cross(forward, right), forward])
    return make_transform(rotation, -rotation @ centre)
