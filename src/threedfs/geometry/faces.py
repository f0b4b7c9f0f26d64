"""Normals and areas of a mesh's faces, and what they give its vertices."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array

from threedfs.geometry.vectors import normalise
from threedfs.types import Mesh


def face_vectors(mesh: Mesh) -> np.ndarray:
    """Return the outward normal of each face times twice its area, (F, 3)."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return np.cross(b - a, c - a)


def face_areas(mesh: Mesh) -> np.ndarray:
    """Return the area (F,) of each face."""
    return np.linalg.norm(face_vectors(mesh), axis=1) / 2


def vertex_normals(mesh: Mesh) -> np.ndarray:
    """Return the outward unit normal (V, 3) at each vertex, the mean of its faces' weighed by their areas."""
    across = face_vectors(mesh)
    total = np.zeros_like(mesh.vertices)
    for axis in range(3):
        for corner in range(3):
            total[:, axis] += np.bincount(mesh.faces[:, corner], across[:, axis], len(total))
    return normalise(total)


def join_vertices(mesh: Mesh) -> csr_array:
    """Return which vertices an edge joins, (V, V), 1 on both sides of the diagonal."""
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    both = np.concatenate([edges, edges[:, ::-1]])
    joined = coo_array((np.ones(len(both)), both.T), shape=(len(mesh.vertices),) * 2).tocsr()
    joined.data[:] = 1
    return joined
