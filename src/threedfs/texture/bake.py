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
    seen = areas.any(axis=1)[texels.face]
    found = np.rint(texels.interpolate(mesh, _color_vertices(mesh, views, areas, read_image))).astype(np.uint8)
    points = texels.interpolate(mesh, mesh.vertices)
    found[seen] = blend_photographs(points[seen], texels.face[seen], areas, views, read_image)
    image, blank = np.zeros((*atlas.shape, 3), np.uint8), np.ones(atlas.shape, bool)
    image[texels.row, texels.column] = found
    blank[texels.row, texels.column] = False
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
