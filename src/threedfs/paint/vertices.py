"""Colours of a mesh's vertices, from the photographs that see them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.sparse import coo_array

from threedfs.geometry.projection import project
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.vectors import dot, normalise
from threedfs.types import Mesh, View

_LEAST_COSINE = 0.3
"""Between a vertex's normal and the ray to a camera, from which the camera shows the vertex rather than its edge."""
_LIFT = 1e-3
"""How far a ray starts from its vertex, lengths of the mesh's box: beyond the faces that meet there."""
_ABSENT = 256


def color_vertices(
    mesh: Mesh, views: Sequence[View], read_image: Callable[[str], np.ndarray], read_valid: Callable[[str], np.ndarray]
) -> np.ndarray:
    """Return the colour (V, 3) uint8 of each vertex: the median over the views that see it, in each channel.

    Not in the paper. A median, as a highlight or an outline a pixel aside is in few views. A vertex that no view sees
    has the mean colour of the nearest ones along the mesh that are seen; a piece of which none is seen is grey.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
    read_image, read_valid : callable
        Give the image (H, W, 3) uint8 RGB of a view by its name, and which pixels (H, W) bool show the scene.
    """
    caster, normals = RayCaster(mesh), vertex_normals(mesh)
    lifted = mesh.vertices + _LIFT * float(np.ptp(mesh.vertices, axis=0).max()) * normals
    samples = np.full((len(views), len(mesh.vertices), 3), _ABSENT, np.uint16)
    for rank, view in enumerate(views):
        rays = view.centre - mesh.vertices
        seen = np.flatnonzero(dot(normals, normalise(rays)) > _LEAST_COSINE)
        pixels, depth = project(view, mesh.vertices[seen])
        image, valid = read_image(view.name), read_valid(view.name)
        column, row = np.rint(pixels).T
        shown = (depth > 0) & (row >= 0) & (column >= 0) & (row < valid.shape[0]) & (column < valid.shape[1])
        seen, row, column = seen[shown], row[shown].astype(np.int64), column[shown].astype(np.int64)
        clear = valid[row, column] & ~caster.is_blocked(lifted[seen], rays[seen])
        samples[rank, seen[clear]] = image[row[clear], column[clear]]
    count = (samples[..., 0] < _ABSENT).sum(axis=0)
    samples.sort(axis=0)
    middle = np.maximum(count - 1, 0)
    low, high = (
        np.take_along_axis(samples, rank[None, :, None], axis=0)[0] for rank in (middle // 2, (middle + 1) // 2)
    )
    return _spread(mesh, (low + high + 1) // 2, count > 0)


def vertex_normals(mesh: Mesh) -> np.ndarray:
    """Return the outward unit normal (V, 3) at each vertex, the mean of its faces' weighed by their areas."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    total = np.zeros_like(mesh.vertices)
    for axis in range(3):
        for corner in range(3):
            total[:, axis] += np.bincount(mesh.faces[:, corner], across[:, axis], len(total))
    return normalise(total)


def _spread(mesh: Mesh, colors: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Return colours (V, 3) uint8, handed on from known vertices to their neighbours, ring by ring."""
    colors = np.where(known[:, None], colors, 0.0)
    pairs = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    pairs = np.concatenate([pairs, pairs[:, ::-1]])
    beside = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(colors),) * 2).tocsr()
    while True:
        weight = beside @ known.astype(np.float64)
        reached = ~known & (weight > 0)
        if not reached.any():
            break
        colors[reached] = (beside @ colors)[reached] / weight[reached, None]
        known = known | reached
    return np.where(known[:, None], np.clip(np.rint(colors), 0, 255), 128).astype(np.uint8)
