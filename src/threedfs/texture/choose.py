"""Which photograph gives each face its shape in the texture: a labelling of the faces with few seams."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from threedfs.geometry.faces import face_areas
from threedfs.geometry.projection import project
from threedfs.segment.alpha_expansion import expand
from threedfs.segment.energy import LabelGraph, energy
from threedfs.texture.vertices import ABSENT
from threedfs.types import Mesh, View

_ROUNDS = 3
"""Times that every view is offered to all faces; a third round changes next to nothing."""


def choose_views(mesh: Mesh, areas: np.ndarray, seam_cost: float) -> np.ndarray:
    """Return the rank (F,) int64 of the view whose shape each face has in the texture, -1 where none shows it whole.

    After Lempitsky and Ivanov (2007): a view is good for a face where it shows it large; an edge between two views
    costs its length. Minimised by alpha expansion.

    Parameters
    ----------
    mesh : Mesh
    areas : (F, views) float32
        As `measure_areas` returns them, of at most 254 views.
    seam_cost : float
        Of an edge as long as the mean one between two views, in what a view of no area costs a mean face.
    """
    shown = areas > 0
    unseen = ~shown.any(axis=1)
    cost = np.where(shown, 1 - areas / np.maximum(areas.max(axis=1, keepdims=True), 1e-12), np.inf)
    nobody = np.where(unseen, 0.0, np.inf)
    share = np.maximum(_share(face_areas(mesh)), 1e-9)  # of no area, infinite costs stay infinite
    unary = np.concatenate([cost, nobody[:, None]], axis=1) * share[:, None]
    pairs, length = adjacent_faces(mesh)
    graph = LabelGraph(
        unary.astype(np.float32), pairs.astype(np.int32), (seam_cost * _share(length)).astype(np.float32)
    )
    labels = unary.argmin(axis=1).astype(np.uint8)
    least = energy(graph, labels)
    for _ in range(_ROUNDS):
        for rank in range(areas.shape[1]):
            labels = expand(graph, labels, rank)
        now = energy(graph, labels)
        if now >= least:
            break
        least = now
    return np.where(unseen, -1, labels.astype(np.int64))


def measure_areas(mesh: Mesh, views: Sequence[View], samples: np.ndarray) -> np.ndarray:
    """Return how large each view shows each face, (F, views) float32 pixels; 0 where it does not see all its corners.

    Parameters
    ----------
    mesh : Mesh
    views : sequence of View
    samples : (views, V, 3) uint16
        As `sample_vertices` returns them.
    """
    areas = np.zeros((len(mesh.faces), len(views)), np.float32)
    for rank, view in enumerate(views):
        sees = (samples[rank, :, 0] < ABSENT)[mesh.faces].all(axis=1)
        corners = project(view, mesh.vertices)[0][mesh.faces[sees]]
        one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        # seen from outside, a face runs clockwise in an image whose rows go down
        turned = one[:, 1] * other[:, 0] - one[:, 0] * other[:, 1]
        areas[sees, rank] = np.maximum(turned / 2, 0)
    return areas


def adjacent_faces(mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs (P, 2) int64 of faces that share an edge, and the edges' lengths (P,)."""
    edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    ends = mesh.vertices[edges[first]]
    return np.stack([first // 3, second // 3], axis=1), np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)


def _share(values: np.ndarray) -> np.ndarray:
    return values / values.mean()
