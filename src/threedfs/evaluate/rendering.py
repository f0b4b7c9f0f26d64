"""True depth: of a mesh in a posed camera, and of what a working frame's pixels show."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.lens import Lens
from threedfs.geometry.projection import pixel_grid
from threedfs.geometry.raycast import RayCaster
from threedfs.types import Camera, Mesh

Distortion = tuple[float, float]


class MeshRenderer:
    """Renders one mesh in many views.

    Parameters
    ----------
    mesh : Mesh
        In the world of the views.
    """

    def __init__(self, mesh: Mesh) -> None:
        self._vertices = mesh.vertices[np.unique(mesh.faces)]
        self._caster = RayCaster(mesh)

    def depth(self, cam_from_world: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Return the depth (...) along the camera's z axis at ideal normalised image points (..., 2).

        NaN where a ray misses the mesh, and at points that are NaN: a lens shows nothing there.
        """
        depth = np.full(points.shape[:-1], np.nan)
        near = self._may_hit(cam_from_world, points)
        if near.any():
            rotation, translation = cam_from_world[:3, :3], cam_from_world[:3, 3]
            directions = np.concatenate([points[near], np.ones((near.sum(), 1))], axis=1) @ rotation
            origins = np.broadcast_to(-rotation.T @ translation, directions.shape)
            hits = self._caster.first_hits(origins, directions)
            # a direction has z = 1 in the camera, so that lengths along it are depths
            depth[near] = np.where(hits.triangle >= 0, hits.distance, np.nan)
        return depth

    def _may_hit(self, cam_from_world: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Say which image points lie in the bounding rectangle of the projected mesh; all, if it passes the camera."""
        in_camera = self._vertices @ cam_from_world[:3, :3].T + cam_from_world[:3, 3]
        if in_camera[:, 2].min() <= 0:
            return np.isfinite(points).all(-1)
        projected = in_camera[:, :2] / in_camera[:, 2:]
        return np.all((points >= projected.min(0)) & (points <= projected.max(0)), axis=-1)


def image_points(camera: Camera, distortion: Distortion, pixels: np.ndarray | None = None) -> np.ndarray:
    """Return the ideal normalised image points (..., 2) that a frame as filmed shows; NaN where there are none.

    Parameters
    ----------
    camera, distortion : Camera, tuple of float
        Of the frame as filmed.
    pixels : (..., 2) float64, optional
        (u, v); all pixel centres, (H, W, 2), without it.
    """
    if pixels is None:
        pixels = np.stack(pixel_grid(camera), axis=-1)
    return Lens(camera, *distortion).normalise(pixels)


def filmed_pixels(camera: Camera, whole: Camera, distortion: Distortion, source_shape: tuple[int, int]) -> np.ndarray:
    """Return where each pixel of an undistorted crop lies in the frame as filmed.

    Parameters
    ----------
    camera : Camera
        Of the crop.
    whole, distortion : Camera, tuple of float
        Of the whole undistorted frame, at any resolution, and what was removed from it.
    source_shape : tuple of int
        (rows, columns) of the source frames.

    Returns
    -------
    (H, W, 2) float64
        (u, v); NaN where the lens shows nothing. Two calibrations of a lens are compared at the same spot of the
        sensor by passing it on to `image_points` of the other one.
    """
    ideal = Lens(camera).normalise(np.stack(pixel_grid(camera), axis=-1))
    return Lens(whole, *distortion).resize(source_shape[1], source_shape[0]).denormalise(ideal)


def sample_nearest(image: np.ndarray, pixels: np.ndarray, outside: float | bool) -> np.ndarray:
    """Return the values (...) of an image (H, W) at the pixel centres nearest to (u, v) (..., 2)."""
    nearest = np.floor(np.nan_to_num(pixels, nan=-1e9) + 0.5)
    u, v = nearest[..., 0], nearest[..., 1]
    inside = (u >= 0) & (v >= 0) & (u < image.shape[1]) & (v < image.shape[0])
    values = np.full(pixels.shape[:-1], outside, image.dtype)
    values[inside] = image[v[inside].astype(int), u[inside].astype(int)]
    return values
