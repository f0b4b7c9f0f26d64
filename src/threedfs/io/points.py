"""Sparse points with visibility."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.types import SparsePoints

POINTS = Schema("threedfs/sparse-points/1", "poses")


def write_points(path: Path, points: SparsePoints, header: Mapping[str, Any]) -> None:
    """Write points.zarr.zip."""
    notes = {"xyz": {"frame": "world", "unit": "scene unit"}, "error": {"unit": "px"}}
    write_arrays(path, POINTS, vars(points), header, notes)


def read_points(path: Path) -> SparsePoints:
    """Read points.zarr.zip."""
    return SparsePoints(**read_arrays(path, POINTS)[0])
