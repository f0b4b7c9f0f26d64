"""Photographs of a coloured mesh: what a camera would see of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from threedfs.geometry.projection import project
from threedfs.geometry.raycast import Hits, RayCaster
from threedfs.texture.pixels import sample_colors
from threedfs.texture.textured import TexturedMesh
from threedfs.types import Mesh, View


class Photographer:
    """Takes photographs of one mesh.

    Parameters
    ----------
    mesh : Mesh
        World.
    color : callable
        Gives the colours (N, 3) float64 RGB at hits.
    """

    def __init__(self, mesh: Mesh, color: Callable[[Hits], np.ndarray]) -> None:
        self._caster, self._vertices, self._color = RayCaster(mesh), mesh.vertices, color

    def take(self, view: View) -> tuple[np.ndarray, np.ndarray]:
        """Return the image (H, W, 3) float32 and where (H, W) bool the mesh is in it; 0 elsewhere."""
        camera = view.camera
        image, shown = np.zeros((*camera.shape, 3), np.float32), np.zeros(camera.shape, bool)
        pixels = project(view, self._vertices)[0]
        if not np.isfinite(pixels).any():
            return image, shown
        low = np.clip(np.floor(np.nanmin(pixels, axis=0)), 0, [camera.width, camera.height]).astype(int)
        high = np.clip(np.ceil(np.nanmax(pixels, axis=0)) + 1, 0, [camera.width, camera.height]).astype(int)
        v, u = np.mgrid[low[1] : high[1], low[0] : high[0]]
        if not u.size:
            return image, shown
        rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones(u.shape)], axis=-1)
        rays = rays.reshape(-1, 3) @ view.cam_from_world[:3, :3]
        hits = self._caster.first_hits(np.broadcast_to(view.centre, rays.shape).copy(), rays)
        hit = hits.triangle >= 0
        there = Hits(hits.triangle[hit], hits.distance[hit], hits.weights[hit])
        shown[v.ravel()[hit], u.ravel()[hit]] = True
        if hit.any():
            image[v.ravel()[hit], u.ravel()[hit]] = self._color(there)
        return image, shown


def photograph_texture(textured: TexturedMesh) -> Photographer:
    """Return what photographs a textured mesh; texels are interpolated."""
    texels = textured.image.astype(np.float32)

    def color(hits: Hits) -> np.ndarray:
        return sample_colors(texels, (hits.weights[:, :, None] * textured.corners[hits.triangle]).sum(axis=1))

    return Photographer(textured.mesh, color)


def photograph_vertices(mesh: Mesh, colors: np.ndarray) -> Photographer:
    """Return what photographs a mesh whose vertices have colours (V, 3)."""

    def color(hits: Hits) -> np.ndarray:
        return (hits.weights[:, :, None] * colors[mesh.faces[hits.triangle]]).sum(axis=1)

    return Photographer(mesh, color)
