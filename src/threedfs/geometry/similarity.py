"""Similarity transforms: the freedom that structure from motion leaves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Similarity:
    """Maps a to b: x_b = scale * rotation @ x_a + translation."""

    scale: float
    rotation: np.ndarray
    translation: np.ndarray

    def apply(self, points: np.ndarray) -> np.ndarray:
        """Map points (..., 3)."""
        return self.scale * points @ self.rotation.T + self.translation

    def apply_to_pose(self, cam_from_a: np.ndarray) -> np.ndarray:
        """Return cam_from_b, its camera axes rigid and its centre mapped."""
        rotation = cam_from_a[:3, :3] @ self.rotation.T
        centre = self.apply(-cam_from_a[:3, :3].T @ cam_from_a[:3, 3])
        cam_from_b = np.eye(4)
        cam_from_b[:3, :3] = rotation
        cam_from_b[:3, 3] = -rotation @ centre
        return cam_from_b


def align(source: np.ndarray, target: np.ndarray) -> Similarity:
    """Fit the least-squares similarity that maps source points (N, 3) onto target points (N, 3).

    References
    ----------
    Umeyama, Least-squares estimation of transformation parameters between two point patterns, 1991.

    Examples
    --------
    >>> a = np.array([[0., 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> round(align(a, 2 * a + 1).scale, 6)
    2.0
    """
    source_mean, target_mean = source.mean(0), target.mean(0)
    source_centred, target_centred = source - source_mean, target - target_mean
    u, singular, vt = np.linalg.svd(target_centred.T @ source_centred / len(source))
    sign = np.diag([1, 1, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = u @ sign @ vt
    scale = float((singular * np.diag(sign)).sum() / (source_centred**2).sum(1).mean())
    return Similarity(scale, rotation, target_mean - scale * rotation @ source_mean)
