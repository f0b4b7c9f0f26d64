"""Normals and areas of a mesh's faces."""

from __future__ import annotations

import numpy as np

from threedfs.types import Mesh


def face_vectors(mesh: Mesh) -> np.ndarray:
    """Return the outward normal of each face times twice its area, (F, 3)."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return np.cross(b - a, c - a)


def face_areas(mesh: Mesh) -> np.ndarray:
    """Return the area (F,) of each face."""
    return np.linalg.norm(face_vectors(mesh), axis=1) / 2
