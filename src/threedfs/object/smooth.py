"""Smoothing of a mesh that keeps its edges (Section 3.5)."""

from __future__ import annotations

import numpy as np

from threedfs.geometry.faces import join_vertices
from threedfs.types import Mesh


def smooth_mesh(mesh: Mesh, steps: int, contrast: float) -> Mesh:
    """Smooth a mesh by vertex-based anisotropic diffusion.

    Each step moves a vertex by half the mean of (g_i + g_j) times the offsets of its neighbours, where g falls from 1
    to 0 as the surface bends at a vertex.

    Differs from the source: the bend is the length of the umbrella vector in mean edges, and neighbours weigh alike.
    The source divides coordinates by the root of a vertex's degree, so that where degrees differ its gradient, and the
    result, depends on the origin of the coordinates.

    Parameters
    ----------
    mesh : Mesh
    steps : int
    contrast : float
        Bend at which a vertex's diffusion has fallen to one half, in mean edges.

    References
    ----------
    Zhang, Ben Hamza, Vertex-based anisotropic smoothing of 3D mesh data, 2006.
    """
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    graph = join_vertices(mesh)
    degree = np.maximum(np.diff(graph.indptr), 1)[:, None]
    vertices = mesh.vertices.copy()
    for _ in range(steps):
        length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1).mean()
        bend = np.linalg.norm(graph @ vertices / degree - vertices, axis=1) / length
        flow = (1 / (1 + (bend / contrast) ** 2))[:, None]
        # sum over neighbours of (g_i + g_j) / 2 (x_j - x_i), without a loop over vertices
        pulled = flow * (graph @ vertices) + graph @ (flow * vertices)
        weight = flow * degree + graph @ flow
        vertices = vertices + 0.5 * (pulled - weight * vertices) / degree
    return Mesh(vertices, mesh.faces)
