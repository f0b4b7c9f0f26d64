"""Casting rays at a mesh with embree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from threedfs.geometry.vectors import dot
from threedfs.types import Mesh


@dataclass(frozen=True)
class Hits:
    """First hits of N rays.

    Attributes
    ----------
    triangle : (N,) int64
        Index of the face, -1 where the ray misses.
    distance : (N,) float64
        In lengths of the ray's direction; infinite where it misses.
    weights : (N, 3) float64
        Barycentric coordinates on the face; 0 where it misses.
    """

    triangle: np.ndarray
    distance: np.ndarray
    weights: np.ndarray


class RayCaster:
    """Finds where rays meet one mesh."""

    def __init__(self, mesh: Mesh) -> None:
        self._corners = mesh.vertices[mesh.faces]
        self._embree = RayMeshIntersector(trimesh.Trimesh(mesh.vertices, mesh.faces, process=False))

    def first_hits(self, origins: np.ndarray, directions: np.ndarray) -> Hits:
        """Find the first hit of rays with origins and directions (N, 3), world.

        Embree picks the triangle in single precision; the point on its plane is then computed in double.
        """
        triangle = np.asarray(self._embree.intersects_first(origins, directions), np.int64)
        distance = np.full(len(triangle), np.inf)
        weights = np.zeros((len(triangle), 3))
        hit = np.flatnonzero(triangle >= 0)
        a, b, c = np.moveaxis(self._corners[triangle[hit]], 1, 0)
        start, ray = origins[hit] - a, directions[hit]
        normal = np.cross(b - a, c - a)
        distance[hit] = -dot(start, normal) / dot(ray, normal)
        point = start + distance[hit, None] * ray
        area = dot(normal, normal)
        weight_b = dot(np.cross(point, c - a), normal) / area
        weight_c = dot(np.cross(b - a, point), normal) / area
        weights[hit] = np.stack([1 - weight_b - weight_c, weight_b, weight_c], axis=-1)
        return Hits(triangle, distance, weights)

    def is_blocked(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Say of each ray (N, 3) whether it meets the mesh at all, (N,) bool."""
        return np.asarray(self._embree.intersects_any(origins, directions))
