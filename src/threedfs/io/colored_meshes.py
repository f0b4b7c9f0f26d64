"""Meshes whose vertices have colours."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import trimesh

from threedfs.io.atomic import atomic
from threedfs.io.meshes import read_mesh
from threedfs.types import Mesh


def write_colored_mesh(
    path: Path, mesh: Mesh, colors: np.ndarray | None, properties: Mapping[str, np.ndarray] | None = None
) -> None:
    """Write a mesh with the colours (V, 3) uint8 RGB of its vertices in the format of the path's ending.

    Binary PLY, OBJ and GLB have colours; STL cannot. PLY has other properties (V,) of the vertices too. Without colours
    as `threedfs.io.meshes.write_mesh`.
    """
    kind = path.suffix.lower().removeprefix(".")
    settings = {"vertex_normal": False} if kind == "ply" else {}
    made = trimesh.Trimesh(
        mesh.vertices, mesh.faces, vertex_colors=colors, vertex_attributes=dict(properties or {}), process=False
    )
    data = made.export(file_type=kind, **settings)
    with atomic(path) as temporary:
        temporary.write_bytes(data.encode() if isinstance(data, str) else data)


def read_colored_mesh(path: Path) -> tuple[Mesh, np.ndarray | None]:
    """Read a mesh and the colours (V, 3) uint8 RGB of its vertices, None where it has none.

    Raises
    ------
    UserError
        As `threedfs.io.meshes.read_mesh`.
    """
    mesh = read_mesh(path)
    visual = trimesh.load(path, force="mesh", process=False).visual
    return mesh, np.asarray(visual.vertex_colors)[:, :3] if visual.kind == "vertex" else None


def read_vertex_property(path: Path, name: str) -> np.ndarray | None:
    """Read a property (V,) of the vertices of a PLY that `write_colored_mesh` wrote; None where it has none."""
    raw = trimesh.load(path, force="mesh", process=False).metadata.get("_ply_raw", {})
    found = raw.get("vertex", {}).get("data")
    return np.asarray(found[name]).ravel() if found is not None and name in (found.dtype.names or ()) else None
