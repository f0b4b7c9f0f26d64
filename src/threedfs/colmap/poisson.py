"""Poisson surface reconstruction of oriented points."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pycolmap
import trimesh

from threedfs.errors import UserError
from threedfs.types import Mesh, OrientedPoints

_FIELDS = [("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("nx", "<f4"), ("ny", "<f4"), ("nz", "<f4")]
_FIELDS += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
_LEAST_POINTS = 100


def mesh_points(points: OrientedPoints, depth: int) -> Mesh:
    """Reconstruct the closed surface of oriented points, on one thread.

    Parameters
    ----------
    points : OrientedPoints
    depth : int
        Of the octree: the surface has up to 2^depth cells along the longest side.

    Raises
    ------
    UserError
        If the points are too few or make no surface.

    References
    ----------
    Kazhdan and Hoppe, Screened Poisson surface reconstruction, 2013.
    """
    if len(points.xyz) < _LEAST_POINTS:
        raise UserError(
            f"Expected at least {_LEAST_POINTS} surface points above the support plane, got {len(points.xyz)}; "
            "raise densify.max_cost or film the object closer and slower."
        )
    options = pycolmap.PoissonMeshingOptions(depth=depth, trim=0.0, color=False, num_threads=1)
    with TemporaryDirectory(prefix="threedfs-") as folder:
        given, made = Path(folder) / "points.ply", Path(folder) / "mesh.ply"
        _write_points(given, points)
        pycolmap.poisson_meshing(given, made, options)
        mesh = trimesh.load(made, force="mesh", process=False)
    if not len(mesh.faces):
        raise UserError("The surface points make no surface; raise densify.max_cost or film the object closer.")
    return Mesh(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64))


def _write_points(path: Path, points: OrientedPoints) -> None:
    rows = np.zeros(len(points.xyz), np.dtype(_FIELDS))
    columns = [*points.xyz.T, *points.normal.T, *points.rgb.T]
    for (name, _), values in zip(_FIELDS, columns, strict=True):
        rows[name] = values
    kinds = {"<f4": "float", "u1": "uchar"}
    properties = "".join(f"property {kinds[kind]} {name}\n" for name, kind in _FIELDS)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{properties}end_header\n"
    path.write_bytes(header.encode("ascii") + rows.tobytes())
