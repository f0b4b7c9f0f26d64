"""Which photograph each face takes its picture from: a labelling of the faces with few seams."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.faces import face_areas
from threedfs.geometry.projection import project
from threedfs.segment.alpha_expansion import expand
from threedfs.segment.energy import LabelGraph, energy
from threedfs.texture.vertices import ABSENT, median_samples
from threedfs.types import Mesh, View

_ROUNDS = 3
"""Times that every view is offered to all faces; a third round changes next to nothing."""


@dataclass(frozen=True)
class ChoiceRule:
    """What a face's photograph costs.

    Attributes
    ----------
    color_scale : float
        Difference from the median colour of all views, levels, that costs as much as a view of no area.
    seam_cost : float
        Of an edge as long as the mean one between two photographs, in what a view of no area costs a mean face.
    """

    color_scale: float
    seam_cost: float


def choose_views(mesh: Mesh, views: Sequence[View], samples: np.ndarray, rule: ChoiceRule) -> np.ndarray:
    """Return the rank (F,) int64 of the view that each face is painted from, -1 where none sees it whole.

    After Lempitsky and Ivanov (2007) and Waechter et al. (2014): a view is good for a face where it shows it large, and
    where it agrees with what the others show (highlights, blur, things in between do not); an edge between two views
    costs its length. Minimised by alpha expansion.

    Parameters
    ----------
    mesh : Mesh
    views : sequence of View
        At most 254.
    samples : (views, V, 3) uint16
        As `sample_vertices` returns them.
    rule : ChoiceRule
    """
    cost = rate_views(mesh, views, samples, rule.color_scale)
    unseen = ~np.isfinite(cost).any(axis=1)
    nobody = np.where(unseen, 0.0, np.inf)
    share = np.maximum(_share(face_areas(mesh)), 1e-9)  # of no area, infinite costs stay infinite
    unary = np.concatenate([cost, nobody[:, None]], axis=1) * share[:, None]
    pairs, length = adjacent_faces(mesh)
    graph = LabelGraph(
        unary.astype(np.float32), pairs.astype(np.int32), (rule.seam_cost * _share(length)).astype(np.float32)
    )
    labels = unary.argmin(axis=1).astype(np.uint8)
    least = energy(graph, labels)
    for _ in range(_ROUNDS):
        for rank in range(len(views)):
            labels = expand(graph, labels, rank)
        now = energy(graph, labels)
        if now >= least:
            break
        least = now
    return np.where(unseen, -1, labels.astype(np.int64))


def rate_views(mesh: Mesh, views: Sequence[View], samples: np.ndarray, color_scale: float) -> np.ndarray:
    """Return what each view costs each face, (F, views) float32; infinite where it does not see all three corners."""
    middle = median_samples(samples)[0].astype(np.float32)
    cost = np.full((len(mesh.faces), len(views)), np.inf, np.float32)
    area = np.zeros_like(cost)
    for rank, view in enumerate(views):
        sees = (samples[rank, :, 0] < ABSENT)[mesh.faces].all(axis=1)
        faces = mesh.faces[sees]
        corners = project(view, mesh.vertices)[0][faces]
        one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        # seen from outside, a face runs clockwise in an image whose rows go down
        turned = one[:, 1] * other[:, 0] - one[:, 0] * other[:, 1]
        apart = np.abs(samples[rank].astype(np.float32) - middle).mean(axis=1)[faces].mean(axis=1)
        area[sees, rank] = np.maximum(turned, 0)
        cost[sees, rank] = np.where(turned > 0, apart / color_scale, np.inf)
    return cost + 1 - area / np.maximum(area.max(axis=1, keepdims=True), 1e-12)


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
