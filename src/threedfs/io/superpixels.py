"""Superpixels of one keyframe."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.segment.superpixels import Superpixels

SUPERPIXELS = Schema("threedfs/superpixels/1", "cues")


def write_superpixels(path: Path, superpixels: Superpixels, header: Mapping[str, Any]) -> None:
    """Write superpixels."""
    write_arrays(path, SUPERPIXELS, vars(superpixels), header, {"index": {"axes": "row, column"}})


def read_superpixels(path: Path) -> Superpixels:
    """Read superpixels."""
    return Superpixels(**read_arrays(path, SUPERPIXELS)[0])
