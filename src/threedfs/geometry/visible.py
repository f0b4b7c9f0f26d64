"""Which vertices of a mesh cameras see."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.geometry.faces import vertex_normals
from threedfs.geometry.projection import project
from threedfs.geometry.raycast import RayCaster
from threedfs.geometry.vectors import dot, normalise
from threedfs.types import Mesh, View

_LIFT = 1e-3
"""How far a ray starts from its vertex, lengths of the mesh's box: beyond the faces that meet there."""


@dataclass(frozen=True)
class Sighting:
    """The vertices that one view sees.

    Attributes
    ----------
    view : View
    vertices : (N,) int64
        Indices.
    row, column : (N,) int64
        Nearest pixels.
    depth : (N,) float64
        In the frame of the camera, scene units.
    cosine : (N,) float64
        Between the normal and the ray to the camera.
    """

    view: View
    vertices: np.ndarray
    row: np.ndarray
    column: np.ndarray
    depth: np.ndarray
    cosine: np.ndarray


def see_vertices(mesh: Mesh, views: Sequence[View], least_cosine: float) -> Iterator[Sighting]:
    """Yield what each view sees: vertices in the image, turned to the camera, with nothing of the mesh before them.

    Parameters
    ----------
    mesh : Mesh
        World.
    views : sequence of View
    least_cosine : float
        Between a vertex's normal and the ray to a camera, from which the camera sees it.
    """
    caster, normals = RayCaster(mesh), vertex_normals(mesh)
    lifted = mesh.vertices + _LIFT * float(np.ptp(mesh.vertices, axis=0).max()) * normals
    for view in views:
        rays = view.centre - mesh.vertices
        cosine = dot(normals, normalise(rays))
        turned = np.flatnonzero(cosine > least_cosine)
        pixels, depth = project(view, mesh.vertices[turned])
        column, row = np.rint(pixels).T
        height, width = view.camera.shape
        shown = (depth > 0) & (row >= 0) & (column >= 0) & (row < height) & (column < width)
        shown[shown] = ~caster.is_blocked(lifted[turned[shown]], rays[turned[shown]])
        seen = turned[shown]
        yield Sighting(
            view, seen, row[shown].astype(np.int64), column[shown].astype(np.int64), depth[shown], cosine[seen]
        )
