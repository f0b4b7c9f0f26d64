"""Charts: pieces of a mesh, each in the shape that one photograph shows, and where each lies in the texture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from threedfs.geometry.faces import face_areas, face_vectors
from threedfs.geometry.plane import axes_on
from threedfs.geometry.projection import project
from threedfs.texture.choose import adjacent_faces
from threedfs.types import Mesh, View

_MARGIN = 2
"""Texels around a chart, so that no picture bleeds into its neighbour's where a viewer interpolates."""
_BLANK = 0.5
"""Resolution of a chart that no photograph shows, against the others': it has no detail."""


@dataclass(frozen=True)
class Atlas:
    """A mesh cut into charts.

    Attributes
    ----------
    shape : (int, int)
        Rows and columns of the texture.
    chart : (F,) int64
        Chart of each face.
    view : (C,) int64
        Rank of the view that gives each chart its shape, -1 for none.
    place, size : (C, 2) int64
        First texel of the chart, (column, row), and its columns and rows.
    corners : (F, 3, 2) float64
        Where each corner of each face lies in the texture, (column, row), whole numbers at texels' centres.
    """

    shape: tuple[int, int]
    chart: np.ndarray
    view: np.ndarray
    place: np.ndarray
    size: np.ndarray
    corners: np.ndarray


def cut_charts(mesh: Mesh, views: Sequence[View], chosen: np.ndarray, texels: float) -> Atlas:
    """Cut the mesh where the photograph changes, and give each piece the shape that its photograph shows it in.

    So nothing is stretched. A piece that no photograph shows is laid flat along its mean normal.

    Parameters
    ----------
    mesh : Mesh
    views : sequence of View
    chosen : (F,) int64
        As `choose_views` returns it.
    texels : float
        To a pixel of the photograph, along a row.
    """
    pairs, _ = adjacent_faces(mesh)
    pairs = pairs[chosen[pairs[:, 0]] == chosen[pairs[:, 1]]]
    joined = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(mesh.faces),) * 2)
    count, chart = connected_components(joined, directed=False)
    view = np.empty(count, np.int64)
    view[chart] = chosen
    corners = np.empty((len(mesh.faces), 3, 2))
    for rank in np.unique(chosen[chosen >= 0]):
        own = chosen == rank
        corners[own] = texels * project(views[rank], mesh.vertices)[0][mesh.faces[own]]
    _lay_flat(mesh, chart, view, corners)
    low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(low, chart, corners.min(axis=1))
    np.maximum.at(high, chart, corners.max(axis=1))
    start = np.floor(low).astype(np.int64) - _MARGIN
    size = np.ceil(high).astype(np.int64) + _MARGIN + 1 - start
    place, shape = pack(size)
    return Atlas(shape, chart, view, place, size, corners + (place - start)[chart][:, None])


def pack(size: np.ndarray) -> tuple[np.ndarray, tuple[int, int]]:
    """Lay rectangles (N, 2), columns and rows, on shelves, the highest first; return their places and the shape."""
    width = max(int(size[:, 0].max()), int(np.ceil(np.sqrt(size.prod(axis=1).sum()))))
    place = np.empty_like(size)
    column = row = height = 0
    for rank in np.lexsort((-size[:, 0], -size[:, 1])):
        if column + size[rank, 0] > width:
            column, row, height = 0, row + height, 0
        place[rank] = column, row
        column, height = column + size[rank, 0], max(height, size[rank, 1])
    return place, (int(row + height), width)


def _lay_flat(mesh: Mesh, chart: np.ndarray, view: np.ndarray, corners: np.ndarray) -> None:
    """Write where the corners of faces that no photograph shows lie, at a resolution that fits the others'."""
    blank = np.flatnonzero(view[chart] < 0)
    if not len(blank):
        return
    painted = corners[view[chart] >= 0]
    one, other = painted[:, 1] - painted[:, 0], painted[:, 2] - painted[:, 0]
    texels = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum() / 2
    areas = face_areas(mesh)
    density = (
        np.sqrt(texels / max(areas[view[chart] >= 0].sum(), 1e-300)) if len(painted) else 100 / np.sqrt(areas.sum())
    )
    across = face_vectors(mesh)
    order = blank[np.argsort(chart[blank], kind="stable")]
    for faces in np.split(order, np.flatnonzero(np.diff(chart[order])) + 1):
        normal = across[faces].sum(axis=0)
        length = np.linalg.norm(normal)
        axes = axes_on(normal / length if length > 0 else np.array([0.0, 0, 1]))
        corners[faces] = _BLANK * density * (mesh.vertices[mesh.faces[faces]] @ axes[:2].T)
