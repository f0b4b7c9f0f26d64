"""Meshes: written as PLY and for other programs, read from any format."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import trimesh

from threedfs.errors import UserError
from threedfs.io.atomic import atomic
from threedfs.types import Mesh


def write_mesh(path: Path, mesh: Mesh) -> None:
    """Write a mesh in the format of the path's ending: binary PLY, or STL, OBJ, GLB."""
    kind = path.suffix.lower().removeprefix(".")
    settings = {"vertex_normal": False} if kind == "ply" else {}
    data = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(file_type=kind, **settings)
    with atomic(path) as temporary:
        temporary.write_bytes(data.encode() if isinstance(data, str) else data)


def read_mesh(path: Path) -> Mesh:
    """Read a triangle mesh from any format that trimesh reads (PLY, OBJ, STL, GLB, ...).

    Raises
    ------
    UserError
        If the file is missing, unreadable or holds no triangles.
    """
    path = Path(path)
    if not path.is_file():
        raise UserError(f"{path}: expected a mesh file, found none; check the path in the configuration.")
    try:
        mesh = trimesh.load(path, force="mesh", process=False)
        return Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))
    except Exception as fault:
        raise UserError(f"{path}: expected a triangle mesh, got something that cannot be read ({fault}).") from fault
