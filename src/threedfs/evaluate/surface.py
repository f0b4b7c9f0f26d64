"""Points on surfaces, and distances to surfaces."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from threedfs.geometry.faces import face_vectors
from threedfs.types import Mesh


def sample_surface(mesh: Mesh, count: int, generator: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Draw points uniformly by area.

    Returns
    -------
    points : (count, 3) float64
    face : (count,) int64
        The triangle of each.
    """
    corners = mesh.vertices[mesh.faces]
    cumulative = np.cumsum(np.linalg.norm(face_vectors(mesh), axis=1))
    face = np.searchsorted(cumulative, generator.random(count) * cumulative[-1], side="right")
    face = np.minimum(face, len(corners) - 1)
    root, second = np.sqrt(generator.random((count, 1))), generator.random((count, 1))
    a, b, c = np.moveaxis(corners[face], 1, 0)
    return (1 - root) * a + root * ((1 - second) * b + second * c), face


class SurfaceDistance:
    """Finds the distance from points to a mesh.

    The triangles that are tried for a point are those whose samples and centroids are nearest to it: centroids find
    the small triangles, samples the large ones. Where the nearest one is missed, the distance is slightly too large.

    Parameters
    ----------
    mesh : Mesh
    samples, face : (N, 3) float64, (N,) int64
        Points on the mesh and their triangles, from `sample_surface`.
    """

    def __init__(self, mesh: Mesh, samples: np.ndarray, face: np.ndarray) -> None:
        self._corners = mesh.vertices[mesh.faces]
        self._face = np.concatenate([face, np.arange(len(mesh.faces))])
        self._tree = cKDTree(np.concatenate([samples, self._corners.mean(1)]))

    def __call__(self, points: np.ndarray, candidates: int = 8) -> np.ndarray:
        """Return the distance (M,) of points (M, 3)."""
        return self.find(points, candidates)[0]

    def find(self, points: np.ndarray, candidates: int = 8) -> tuple[np.ndarray, np.ndarray]:
        """Return the distance (M,) of points (M, 3), and the triangle (M,) int64 that is nearest to each."""
        candidates = min(candidates, len(self._face))
        _, nearest = self._tree.query(points, k=list(range(1, candidates + 1)))
        distance, face = np.full(len(points), np.inf), np.zeros(len(points), np.int64)
        for column in nearest.T:
            triangle = self._face[column]
            apart = triangle_distance(points, self._corners[triangle])
            face = np.where(apart < distance, triangle, face)
            distance = np.minimum(distance, apart)
        return distance, face


def triangle_distance(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the distance (N,) of each point (N, 3) from its own triangle, corners (N, 3, 3).

    A triangle without area counts as its edges.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    distance = np.minimum(
        np.minimum(_segment_distance(points, a, b), _segment_distance(points, b, c)),
        _segment_distance(points, c, a),
    )
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    above = np.ones(len(points), bool)
    for start, end in ((a, b), (b, c), (c, a)):
        above &= (np.cross(end - start, points - start) * normal).sum(1) >= 0
    inside = above & (area > 0)
    height = np.abs(((points - a) * normal).sum(1)[inside]) / area[inside]
    distance[inside] = np.minimum(distance[inside], height)
    return distance


def _segment_distance(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    along = end - start
    length = (along**2).sum(1)
    share = ((points - start) * along).sum(1) / np.where(length > 0, length, 1)
    return np.linalg.norm(points - start - np.clip(share, 0, 1)[:, None] * along, axis=1)
