"""Levels out what the photographs on two sides of a seam differ by: exposure, white balance, shading."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from scipy.sparse import coo_array, eye_array
from scipy.sparse.linalg import splu

from threedfs.geometry.projection import project
from threedfs.object.silhouettes import draw_silhouette
from threedfs.texture.pixels import sample_colors
from threedfs.texture.vertices import Reader, spread_colors
from threedfs.types import Mesh, View

_BLUR = 2.0
"""Pixels around a vertex over which its colour is taken: a pattern a pixel aside is not levelled."""
_SMOOTHNESS = 0.1
"""Weight of equal corrections at the ends of an edge, against equal colours on both sides of a seam."""
_ANCHOR = 0.1
"""Weight of no correction: with less, corrections wander over the mesh, away from every photograph."""


def level_seams(mesh: Mesh, views: Sequence[View], chosen: np.ndarray, read_image: Reader) -> np.ndarray:
    """Return what is to be added to the photograph at each corner of each face, (F, 3, 3) float64, RGB levels.

    After Lempitsky and Ivanov (2007): corrections that are smooth within a photograph's faces, and make both sides of a
    seam equal at its vertices. Faces that no photograph paints have the whole colour here, handed on from those beside.

    Parameters
    ----------
    mesh : Mesh
    views : sequence of View
    chosen : (F,) int64
        As `choose_views` returns it.
    read_image : callable
        Gives the image (H, W, 3) uint8 RGB of a view by its name.
    """
    painted = chosen >= 0
    keys = mesh.faces[painted] * len(views) + chosen[painted, None]
    nodes, node = np.unique(keys, return_inverse=True)
    node = node.reshape(keys.shape)
    vertex, rank = nodes // len(views), nodes % len(views)
    colors = _sample(mesh, views, vertex, rank, read_image)
    correction = _solve(vertex, node, colors)
    levelled = colors + correction
    known = np.bincount(vertex, minlength=len(mesh.vertices))
    total = np.stack([np.bincount(vertex, channel, len(known)) for channel in levelled.T], axis=1)
    everywhere = spread_colors(mesh, total / np.maximum(known, 1)[:, None], known > 0)
    added = everywhere[mesh.faces]
    added[painted] = correction[node]
    return added


def _sample(mesh: Mesh, views: Sequence[View], vertex: np.ndarray, rank: np.ndarray, read_image: Reader) -> np.ndarray:
    """Return the colour (N, 3) float64 of vertices in the photographs of their faces."""
    colors = np.empty((len(vertex), 3))
    for each in np.unique(rank):
        own = np.flatnonzero(rank == each)
        pixels = project(views[each], mesh.vertices[vertex[own]])[0]
        image = _blur_inside(read_image(views[each].name), draw_silhouette(mesh, views[each]))
        colors[own] = sample_colors(image, pixels)
    return colors


def _blur_inside(image: np.ndarray, inside: np.ndarray) -> np.ndarray:
    """Return the blurred image (H, W, 3) float32 of what is inside an outline: what surrounds it takes no part."""
    weight = inside.astype(np.float32)
    total = cv2.GaussianBlur(image * weight[..., None], (0, 0), _BLUR)
    return total / np.maximum(cv2.GaussianBlur(weight, (0, 0), _BLUR), 1e-3)[..., None]


def _solve(vertex: np.ndarray, node: np.ndarray, colors: np.ndarray) -> np.ndarray:
    """Return the correction (N, 3) of each node: nodes of one vertex in a row, faces' corners by their nodes (F, 3)."""
    seam = np.flatnonzero(vertex[1:] == vertex[:-1])
    edges = np.unique(np.sort(node[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    ends = np.concatenate([np.stack([seam, seam + 1], axis=1), edges])
    weight = np.concatenate([np.ones(len(seam)), np.full(len(edges), _SMOOTHNESS)])
    rows = np.repeat(np.arange(len(ends)), 2)
    difference = coo_array(
        (np.tile([1.0, -1.0], len(ends)), (rows, ends.ravel())), shape=(len(ends), len(vertex))
    ).tocsr()
    wanted = np.zeros((len(ends), 3))
    wanted[: len(seam)] = colors[seam + 1] - colors[seam]
    weighed = difference.T.multiply(weight).tocsr()
    return splu((weighed @ difference + _ANCHOR * eye_array(len(vertex))).tocsc()).solve(weighed @ wanted)
