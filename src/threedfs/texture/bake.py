"""The texture: each texel as the photographs show its point of the mesh, blended."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import distance_transform_edt

from threedfs.texture.blend import blend_photographs
from threedfs.texture.charts import Atlas
from threedfs.texture.texels import locate_texels
from threedfs.texture.textured import TexturedMesh
from threedfs.texture.vertices import Reader, spread_colors
from threedfs.types import Mesh, View

_BLOCK = 250_000
"""Texels at once: each has a sample, and a weight, of every view."""


def bake_texture(
    mesh: Mesh, views: Sequence[View], atlas: Atlas, areas: np.ndarray, read_image: Reader
) -> TexturedMesh:
    """Return the mesh with its texture.

    Faces that no view shows whole have the colours of the vertices beside them, handed on; texels that show no face are
    as the nearest that does.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
    atlas : Atlas
        As `cut_charts` returns it.
    areas : (F, views) float32
        As `measure_areas` returns them.
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a view by its name.
    """
    texels = locate_texels(atlas)
    image, blank = np.zeros((*atlas.shape, 3), np.uint8), np.ones(atlas.shape, bool)
    blank[texels.row, texels.column] = False
    seen = areas.any(axis=1)[texels.face]
    if not seen.all():
        some, colors = texels.take(~seen), _color_vertices(mesh, views, areas, read_image)
        image[some.row, some.column] = np.rint(some.interpolate(mesh, colors))
    shown = texels.take(seen)
    for start in range(0, len(shown.face), _BLOCK):
        some = shown.take(slice(start, start + _BLOCK))
        points = some.interpolate(mesh, mesh.vertices)
        image[some.row, some.column] = blend_photographs(points, some.face, areas, views, read_image)
    nearest = distance_transform_edt(blank, return_distances=False, return_indices=True)
    return TexturedMesh(mesh, atlas.corners, image[tuple(nearest)])


def _color_vertices(mesh: Mesh, views: Sequence[View], areas: np.ndarray, read_image: Reader) -> np.ndarray:
    """Return the colours (V, 3) float64 of vertices, blended where a face beside them is shown, else handed on."""
    around = np.zeros((len(mesh.vertices), areas.shape[1]), np.float32)
    for corner in range(3):
        np.add.at(around, mesh.faces[:, corner], areas)
    known = around.any(axis=1)
    colors = np.zeros((len(around), 3))
    colors[known] = blend_photographs(mesh.vertices[known], np.flatnonzero(known), around, views, read_image)
    return spread_colors(mesh, colors, known)
