"""Planes through points: least squares, and a robust search."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from threedfs.types import Plane

_CHUNK = 256  # candidates scored at once


def fit_plane(points: np.ndarray, weights: np.ndarray | None = None) -> Plane:
    """Fit the plane with the least weighted sum of squared distances to points (N, 3); its sign is arbitrary.

    Examples
    --------
    >>> plane = fit_plane(np.array([[0.0, 0, 2], [1, 0, 2], [0, 1, 2], [1, 1, 2]]))
    >>> np.abs(np.round(plane.normal, 6)), abs(round(plane.offset, 6))
    (array([0., 0., 1.]), 2.0)
    """
    weights = np.ones(len(points)) if weights is None else weights
    centre = np.average(points, axis=0, weights=weights)
    offsets = points - centre
    _, vectors = np.linalg.eigh((offsets * weights[:, None]).T @ offsets)
    normal = vectors[:, 0]
    return Plane(normal, float(-normal @ centre))


def axes_on(normal: np.ndarray) -> np.ndarray:
    """Return right-handed orthonormal axes (3, 3), as rows, of which the third is a unit normal (3,)."""
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(normal, across), normal])


def propose_planes(
    points: np.ndarray, probabilities: np.ndarray, count: int, generator: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Draw triples of points and return the planes through them.

    Parameters
    ----------
    points : (N, 3) float64
    probabilities : (N,) float64
        Of drawing each point; they sum to 1.
    count : int
        Triples drawn; those of points on a line or drawn twice give no plane.
    generator : numpy.random.Generator

    Returns
    -------
    normals : (M, 3) float64, unit length, sign arbitrary
    offsets : (M,) float64
    """
    corners = points[generator.choice(len(points), size=(count, 3), p=probabilities)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1)
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    usable = length > 0.05 * longest**2  # a flatter triangle leaves the normal to the noise
    normals = normals[usable] / length[usable, None]
    return normals, -(normals * corners[usable, 0]).sum(axis=1)


def score_planes(
    normals: np.ndarray, offsets: np.ndarray, points: np.ndarray, score: Callable[[np.ndarray, np.ndarray], np.ndarray]
) -> np.ndarray:
    """Score candidate planes, a few at a time.

    Parameters
    ----------
    normals : (M, 3) float64
    offsets : (M,) float64
    points : (N, 3) float64
    score : callable
        Maps normals (m, 3) and distances (m, N) of the points to scores (m,).

    Returns
    -------
    (M,) float64
    """
    scores = [
        score(normals[i : i + _CHUNK], normals[i : i + _CHUNK] @ points.T + offsets[i : i + _CHUNK, None])
        for i in range(0, len(normals), _CHUNK)
    ]
    return np.concatenate(scores) if scores else np.empty(0)


def widest_gap(offsets: np.ndarray, up: np.ndarray) -> float:
    """Return the widest angle around an axis, degrees, in which none of the directions (N, 3) lies."""
    first = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    turns = np.sort(np.degrees(np.arctan2(offsets @ np.cross(up, first), offsets @ first)))
    return float(np.diff(turns, append=turns[:1] + 360).max())
