"""The closed surface of a field."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from threedfs.errors import UserError
from threedfs.geometry.grid import world_from_index
from threedfs.types import Mesh, VoxelGrid

_LEAST = 1e-3  # the field keeps so far from zero at voxels, or triangles shrink to nothing there


def extract_surface(sdf: np.ndarray, grid: VoxelGrid) -> Mesh:
    """Extract the zero level surface as one closed mesh with normals toward positive values.

    Where the interior reaches the border of the grid, the surface closes there. Of several shells (cavities
    inside, specks outside) the one that encloses the largest volume is kept.

    Parameters
    ----------
    sdf : (nx, ny, nz) float32, negative inside
    grid : VoxelGrid

    Raises
    ------
    UserError
        If the field is negative nowhere.
    """
    if not (sdf < 0).any():
        raise UserError(
            "The object's field is positive everywhere, so it has no surface; lower locate_object.clearance."
        )
    away = np.where(sdf < 0, np.minimum(sdf, -_LEAST), np.maximum(sdf, _LEAST))
    padded = np.pad(away, 1, constant_values=1)
    # Lewiner's variant, the default, puts four triangles on an edge where clipped values tie.
    vertices, faces, _, _ = marching_cubes(padded, 0.0, gradient_direction="ascent", method="lorensen")
    vertices = world_from_index(grid, vertices.astype(np.float64) - 1)
    faces = faces.astype(np.int64)
    if enclosed_volume(Mesh(vertices, faces)) < 0:
        faces = faces[:, ::-1]
    return keep_largest_shell(Mesh(vertices, faces))


def enclosed_volume(mesh: Mesh) -> float:
    """Return the volume that a closed mesh encloses, positive where its faces turn outward."""
    return float(_volumes(mesh).sum())


def _volumes(mesh: Mesh) -> np.ndarray:
    """Return the signed volume (F,) between each face and the middle of the vertices."""
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] - mesh.vertices.mean(axis=0) for corner in range(3))
    return (np.cross(a, b) * c).sum(axis=1) / 6


def find_shells(mesh: Mesh) -> np.ndarray:
    """Return the number (V,) int32 of the connected part that each vertex is in; one of no face is a part alone."""
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]]])
    count = len(mesh.vertices)
    graph = coo_array((np.ones(len(edges), bool), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def keep_largest_shell(mesh: Mesh) -> Mesh:
    """Keep that connected part of a closed mesh which encloses the largest volume."""
    shell = find_shells(mesh)
    volume = np.bincount(shell[mesh.faces[:, 0]], _volumes(mesh))
    return _keep_vertices(mesh, shell == np.argmax(volume))


def drop_shreds(mesh: Mesh, least_share: float) -> Mesh:
    """Drop connected parts of a closed mesh that enclose less than a share of the volume of the largest one.

    Parameters
    ----------
    mesh : Mesh
    least_share : float
        Of volumes as they are, whichever way faces turn.
    """
    shell = find_shells(mesh)
    volume = np.abs(np.bincount(shell[mesh.faces[:, 0]], _volumes(mesh), minlength=shell.max() + 1))
    return _keep_vertices(mesh, volume[shell] >= least_share * volume.max())


def _keep_vertices(mesh: Mesh, kept: np.ndarray) -> Mesh:
    """Return the mesh of some vertices (V,) bool, all or none of each face's."""
    renumbered = np.cumsum(kept) - 1
    return Mesh(mesh.vertices[kept], renumbered[mesh.faces[kept[mesh.faces[:, 0]]]])
