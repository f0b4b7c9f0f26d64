"""Meshes that a person gives: which surfaces nothing can be measured on."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.geometry.faces import face_vectors
from threedfs.io.meshes import read_mesh
from threedfs.types import Mesh


def read_given_mesh(path: Path) -> Mesh:
    """Read a triangle mesh that is measured, or measured against.

    Raises
    ------
    UserError
        If it cannot be read, has no faces, has vertices that are no finite numbers or faces that name none, or has no
        area.
    """
    mesh = read_mesh(path)
    if mesh.vertices.ndim != 2 or mesh.faces.ndim != 2 or len(mesh.faces) == 0:
        raise UserError(f"{path}: expected a triangle mesh, got {len(mesh.vertices)} points without faces; mesh them.")
    used = np.unique(mesh.faces)
    if used[0] < 0 or used[-1] >= len(mesh.vertices):
        raise UserError(
            f"{path}: expected faces of its {len(mesh.vertices)} vertices, got one that names vertex "
            f"{used[0] if used[0] < 0 else used[-1]}; export the mesh again."
        )
    if not np.all(np.isfinite(mesh.vertices[used])):
        raise UserError(f"{path}: expected vertices that are finite numbers, got NaN or infinity; export it again.")
    with np.errstate(over="ignore", invalid="ignore"):
        area = float(np.linalg.norm(face_vectors(mesh), axis=1).sum()) / 2
        diagonal = float(np.linalg.norm(np.ptp(mesh.vertices[used], axis=0)))
    # the rounding of a far-away origin gives faces on one line some area
    if not np.finfo(np.float64).eps * diagonal**2 < area < np.inf:
        raise UserError(
            f"{path}: expected a surface with an area, got {len(mesh.faces)} faces of area {area:.3g} together; all of "
            "them lie on a point or a line, or their coordinates are far too large."
        )
    return mesh
