"""The texture: pixels of the chosen photographs, levelled, each chart at its place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.ndimage import distance_transform_edt

from threedfs.texture.charts import Atlas
from threedfs.texture.textured import TexturedMesh
from threedfs.texture.vertices import Reader
from threedfs.types import Mesh, View

_SLACK = 1.0
"""Texels outside of a face that are painted as its edge is: those that interpolation reads."""


def bake_texture(
    mesh: Mesh, views: Sequence[View], atlas: Atlas, added: np.ndarray, read_image: Reader
) -> TexturedMesh:
    """Return the mesh with its texture: every texel of a face from its photograph, all others as the nearest of those.

    Parameters
    ----------
    mesh : Mesh
    views : sequence of View
    atlas : Atlas
        As `cut_charts` returns it.
    added : (F, 3, 3) float64
        As `level_seams` returns it.
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a view by its name.
    """
    image = np.zeros((*atlas.shape, 3), np.uint8)
    for rank in np.unique(atlas.view[atlas.view >= 0]):
        picture = read_image(views[rank].name)
        for chart in np.flatnonzero(atlas.view == rank):
            (column, row), (columns, rows) = atlas.place[chart], atlas.size[chart]
            u = np.clip(atlas.start[chart, 0] + np.arange(columns), 0, picture.shape[1] - 1)
            v = np.clip(atlas.start[chart, 1] + np.arange(rows), 0, picture.shape[0] - 1)
            image[row : row + rows, column : column + columns] = picture[v[:, None], u]
    correction = np.zeros((*atlas.shape, 3), np.float32)
    painted = np.zeros(atlas.shape, bool)
    for slack in (_SLACK, 0.0):
        _raster(atlas.corners, added, slack, correction, painted)
    levelled = np.clip(np.rint(image + correction), 0, 255).astype(np.uint8)
    nearest = distance_transform_edt(~painted, return_distances=False, return_indices=True)
    return TexturedMesh(mesh, atlas.corners, levelled[tuple(nearest)])


@njit(cache=True)
def _raster(corners, added, slack, correction, painted):
    """Write the corners' values, interpolated, at the texels of each face, and up to `slack` texels outside of it."""
    rows, columns = painted.shape
    for face in range(len(corners)):
        ax, ay = corners[face, 0]
        bx, by = corners[face, 1]
        cx, cy = corners[face, 2]
        twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if twice == 0:
            continue
        # how much a weight changes across the slack, on the side opposite to each corner
        limit_a = -slack * np.hypot(cx - bx, cy - by) / abs(twice)
        limit_b = -slack * np.hypot(cx - ax, cy - ay) / abs(twice)
        limit_c = -slack * np.hypot(bx - ax, by - ay) / abs(twice)
        first = max(0, int(np.floor(min(ax, bx, cx) - slack)))
        last = min(columns - 1, int(np.ceil(max(ax, bx, cx) + slack)))
        for row in range(
            max(0, int(np.floor(min(ay, by, cy) - slack))), min(rows - 1, int(np.ceil(max(ay, by, cy) + slack))) + 1
        ):
            for column in range(first, last + 1):
                b = ((column - ax) * (cy - ay) - (row - ay) * (cx - ax)) / twice
                c = ((bx - ax) * (row - ay) - (by - ay) * (column - ax)) / twice
                a = 1 - b - c
                if a >= limit_a and b >= limit_b and c >= limit_c:
                    # held to the face, or a sliver's values run away
                    a, b, c = max(a, 0.0), max(b, 0.0), max(c, 0.0)
                    whole = a + b + c
                    painted[row, column] = True
                    for channel in range(3):
                        correction[row, column, channel] = (
                            a * added[face, 0, channel] + b * added[face, 1, channel] + c * added[face, 2, channel]
                        ) / whole
