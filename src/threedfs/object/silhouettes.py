"""The outline of a mesh in an image."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from threedfs.frames.scale import scale_camera
from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import project
from threedfs.geometry.rigid import apply
from threedfs.types import Mesh, View


def draw_silhouette(mesh: Mesh, view: View) -> np.ndarray:
    """Return the mask (H, W) bool of a mesh in the undistorted image of a view."""
    pixels, _ = project(view, mesh.vertices)
    return rasterise(pixels, mesh.faces, view.camera.shape)


def draw_source_silhouette(
    mesh: Mesh, view: View, distortion: tuple[float, float], source_shape: tuple[int, int]
) -> np.ndarray:
    """Return the mask of a mesh in the frame as it was filmed.

    The vertices are distorted and the mask is drawn at the source's resolution, so that nothing is resampled.

    Parameters
    ----------
    mesh : Mesh
    view : View
        Of the undistorted working frame.
    distortion : tuple of float
        (k1, k2), see `threedfs.geometry.distortion`.
    source_shape : tuple of int
        (Hs, Ws) of the source frames.

    Returns
    -------
    (Hs, Ws) bool
    """
    camera = scale_camera(view.camera, source_shape, f"silhouette of {view.name}")
    points = apply(view.cam_from_world, mesh.vertices)
    depth = np.where(points[:, 2:] > 0, points[:, 2:], np.nan)
    return rasterise(Lens(camera, *distortion).denormalise(points[:, :2] / depth), mesh.faces, source_shape)


def rasterise(pixels: np.ndarray, faces: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Mark the pixels whose centres lie in the projection of any triangle.

    Parameters
    ----------
    pixels : (V, 2) float64
        Projected vertices (u, v); triangles with a vertex that is NaN, as behind the camera, are left out.
    faces : (F, 3) int64
    shape : tuple of int
        (H, W) of the image.

    Returns
    -------
    (H, W) bool
    """
    mask = np.zeros(shape, np.bool_)
    _fill(np.ascontiguousarray(pixels, np.float64), np.ascontiguousarray(faces, np.int64), mask)
    return mask


@njit(nogil=True, cache=True)
def _fill(pixels, faces, mask):
    rows, columns = mask.shape
    for face in range(faces.shape[0]):
        au, av = pixels[faces[face, 0], 0], pixels[faces[face, 0], 1]
        bu, bv = pixels[faces[face, 1], 0], pixels[faces[face, 1], 1]
        cu, cv = pixels[faces[face, 2], 0], pixels[faces[face, 2], 1]
        if math.isnan(au + bu + cu):
            continue
        first_row, last_row = max(0, math.ceil(min(av, bv, cv))), min(rows - 1, math.floor(max(av, bv, cv)))
        first_column, last_column = max(0, math.ceil(min(au, bu, cu))), min(columns - 1, math.floor(max(au, bu, cu)))
        # Edges belong to the triangle, whichever way it turns, so that neighbours leave no gap between them.
        for row in range(first_row, last_row + 1):
            for column in range(first_column, last_column + 1):
                ab = (bu - au) * (row - av) - (bv - av) * (column - au)
                bc = (cu - bu) * (row - bv) - (cv - bv) * (column - bu)
                ca = (au - cu) * (row - cv) - (av - cv) * (column - cu)
                if (ab >= 0 and bc >= 0 and ca >= 0) or (ab <= 0 and bc <= 0 and ca <= 0):
                    mask[row, column] = True
