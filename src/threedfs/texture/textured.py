"""A mesh with a picture on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from threedfs.types import Mesh


@dataclass(frozen=True)
class TexturedMesh:
    """A mesh with a picture on it.

    Attributes
    ----------
    mesh : Mesh
    corners : (F, 3, 2) float64
        Where each corner of each face lies in the picture, (column, row), whole numbers at texels' centres.
    image : (H, W, 3) uint8 RGB
    """

    mesh: Mesh
    corners: np.ndarray
    image: np.ndarray


@dataclass(frozen=True)
class CutMesh:
    """A textured mesh cut along its charts, as most formats want it: each vertex has one place in the picture.

    Attributes
    ----------
    vertex : (N,) int64
        The mesh's vertex that each one is.
    faces : (F, 3) int64
    places : (N, 2) float64
        u to the right and v up, in [0, 1].
    """

    vertex: np.ndarray
    faces: np.ndarray
    places: np.ndarray


def cut_charts(textured: TexturedMesh) -> CutMesh:
    """Return the mesh with its vertices once for each place in the picture."""
    faces = textured.mesh.faces
    keys = np.concatenate([faces.reshape(-1, 1), textured.corners.reshape(-1, 2)], axis=1)
    kept, corner = np.unique(keys, axis=0, return_inverse=True)
    places = scale_places(kept[:, 1:], textured.image)
    return CutMesh(kept[:, 0].astype(np.int64), corner.reshape(faces.shape), places)


def scale_places(places: np.ndarray, image: np.ndarray) -> np.ndarray:
    """Return places (N, 2) in texels, columns and rows, as u to the right and v up in [0, 1]."""
    height, width = image.shape[:2]
    u, v = ((places + 0.5) / [width, height]).T
    return np.stack([u, 1 - v], axis=1)
