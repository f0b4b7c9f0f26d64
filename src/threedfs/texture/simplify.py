"""A mesh of fewer faces for a texture: as close to the first one as is asked, and closed if that is."""

from __future__ import annotations

import manifold3d
import numpy as np

from threedfs.geometry.faces import vertex_normals
from threedfs.object.extract import drop_shreds
from threedfs.types import Mesh

_APART = 1e-5
"""How far vertices at one place are moved apart, lengths of the diagonal of the mesh's box."""

_SHRED = 1e-6
"""Share of the largest part's volume up to which another part is a shred: what is left of a neck that was taken out."""


def simplify_mesh(mesh: Mesh, tolerance: float) -> Mesh | None:
    """Return the mesh with the vertices taken out that no face needs to be as near; None if it is not closed.

    Parameters
    ----------
    mesh : Mesh
    tolerance : float
        Distance that a vertex may lie from the faces that replace it, lengths of the diagonal of the mesh's box.

    Returns
    -------
    Mesh or None
        Closed, with no more handles and parts than before, and no two vertices at one place.
    """
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    diagonal = float(np.linalg.norm(high - low))
    unit = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray((mesh.vertices - low) / diagonal), tri_verts=mesh.faces.astype(np.uint64)
    )
    solid = manifold3d.Manifold(unit)
    if solid.status() != manifold3d.Error.NoError:
        return None
    fewer = solid.simplify(tolerance).to_mesh64()
    if not len(fewer.tri_verts):
        return None
    found = Mesh(np.asarray(fewer.vert_properties, np.float64)[:, :3], np.asarray(fewer.tri_verts, np.int64))
    kept = drop_shreds(found, _SHRED)
    return Mesh(_part(kept.vertices, kept.faces) * diagonal + low, kept.faces)


def _part(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Move vertices (V, 3) at one place apart, each a little into its own side.

    Formats such as STL know vertices by their place: where two sheets meet in an edge, four faces would share it.
    """
    _, place, count = np.unique(vertices.astype(np.float32), axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    shared = np.flatnonzero(count[place] > 1)
    if len(shared) == 0:
        return vertices
    normals = vertex_normals(Mesh(vertices, faces))[shared]
    groups = np.sort(place[shared])
    ranks = np.empty(len(shared), np.int64)
    ranks[np.argsort(place[shared], kind="stable")] = np.arange(len(shared)) - np.searchsorted(groups, groups)
    moved = vertices.copy()
    moved[shared] -= _APART * (1 + ranks)[:, None] * normals
    return moved
