"""Oriented surface points with visibility."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.types import OrientedPoints

ORIENTED_POINTS = Schema("threedfs/oriented-points/1", "densify")


def write_oriented_points(
    path: Path, points: OrientedPoints, views: Sequence[str], engine: str, header: Mapping[str, Any]
) -> None:
    """Write points, the names of the keyframes that `seen_view` counts, and what matched the patches."""
    notes = {"xyz": {"frame": "world", "unit": "scene unit"}, "normal": {"frame": "world"}}
    write_arrays(path, ORIENTED_POINTS, vars(points), header, notes, views=list(views), engine=engine)


def read_oriented_points(path: Path) -> tuple[OrientedPoints, str]:
    """Read points, and what matched the patches: "cpu", "cuda", or "off" if no points were wanted."""
    arrays, attributes = read_arrays(path, ORIENTED_POINTS)
    return OrientedPoints(**arrays), attributes["engine"]
