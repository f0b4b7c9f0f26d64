"""A mesh of fewer faces for a texture: as close to the first one as is asked, and closed if that is."""

from __future__ import annotations

import manifold3d
import numpy as np

from threedfs.types import Mesh


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
        Closed, with no more handles than before.
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
    vertices = np.asarray(fewer.vert_properties, np.float64)[:, :3] * diagonal + low
    return Mesh(vertices, np.asarray(fewer.tri_verts, np.int64))
