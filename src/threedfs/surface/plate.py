"""A surface that is as smooth as a bent plate where no depth holds it."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, diags_array, eye_array
from scipy.sparse.linalg import cg

from threedfs.geometry.faces import join_vertices, vertex_normals
from threedfs.geometry.vectors import dot, normalise
from threedfs.geometry.visible import see_vertices
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.types import Mesh, Plane

_GRAZING, _SQUARE = 0.2, 0.5
"""Cosines between a vertex's normal and the ray to a camera: up to the first its depth says nothing of the vertex,
from the second all that it is trusted to; between them in proportion."""
_FULL = 3.0
"""Summed trust that holds a vertex fully."""
_LEAST = 0.03
"""What holds a vertex of which no depth is known: masks and the medians of its field."""
_NORMAL_ROUNDS = 3
"""How often a normal becomes the mean of its own and its neighbours': a vertex does not move along a bump's slope."""


def support_vertices(mesh: Mesh, depth: ConfirmedDepth, plane: Plane) -> np.ndarray:
    """Return how far trusted depth holds each vertex where it is, (V,) float64 in [0, 1].

    Not in the paper. The trust of the views that see a vertex is summed, the less of it, the farther their depth is
    from the vertex, in voxels. What stands on the support plane is held by it.
    """
    spacing = depth.fused.grid.spacing
    total = np.zeros(len(mesh.vertices))
    for seen in see_vertices(mesh, list(depth.views.values()), _GRAZING):
        found = depth.read(seen.view.name)[seen.row, seen.column]
        trust = depth.trust[seen.view.name][seen.row, seen.column]
        apart = (found - seen.depth) * seen.cosine / spacing
        near = np.where(np.isfinite(apart), np.exp(-(apart**2) / 2), 0.0)
        total[seen.vertices] += trust * near * np.minimum(1, seen.cosine / _SQUARE)
    held = np.clip(total / _FULL, _LEAST, 1.0)
    return np.where(plane.distance(mesh.vertices) < spacing, 1.0, held)


def bend_mesh(mesh: Mesh, support: np.ndarray, stiffness: float) -> Mesh:
    """Return the mesh with its vertices moved along their normals until it bends least for what holds them.

    Not in the paper. The moves d minimise sum support d^2 + stiffness |umbrella vectors along the normals|^2, which is
    the energy of a thin plate on a mesh of equal edges.

    Parameters
    ----------
    mesh : Mesh
        Of edges that are about equal, as from a grid.
    support : (V,) float64
        As `support_vertices` returns it.
    stiffness : float
    """
    beside, normals = _mean_beside(mesh), vertex_normals(mesh)
    for _ in range(_NORMAL_ROUNDS):
        normals = normalise(normals + beside @ normals)
    umbrella = beside - eye_array(len(normals))
    parts = coo_array(umbrella)
    along = dot(normals[parts.row], normals[parts.col])
    bend = coo_array((parts.data * along, (parts.row, parts.col)), shape=parts.shape).tocsr()
    matrix = diags_array(support) + stiffness * (bend.T @ bend)
    force = -stiffness * (bend.T @ dot(normals, umbrella @ mesh.vertices))
    moves, _ = cg(matrix, force, rtol=1e-4, maxiter=400, M=diags_array(1 / matrix.diagonal()))
    return Mesh(mesh.vertices + moves[:, None] * normals, mesh.faces)


def _mean_beside(mesh: Mesh) -> csr_array:
    """Return what gives each vertex the mean of its neighbours' values, (V, V)."""
    joined = join_vertices(mesh)
    return (diags_array(1 / np.maximum(np.diff(joined.indptr), 1)) @ joined).tocsr()
