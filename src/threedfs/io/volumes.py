"""Volumes on a voxel grid, the support plane, silhouettes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.documents import read_document, write_document
from threedfs.io.grids import describe_grid, grid_of
from threedfs.io.schema import Schema
from threedfs.types import Box, Plane, Support, VoxelGrid

SILHOUETTES = Schema("threedfs/silhouettes/1", "object, poisson, pixel_masks, cut_object or surface")
SUPPORT = Schema("threedfs/support/2", "locate")
VOLUME = Schema("threedfs/volume/2", "fuse_scene, fuse_object, fuse_baseline, deform or object")


@dataclass(frozen=True)
class Volume:
    """A signed distance field on a grid.

    Attributes
    ----------
    grid : VoxelGrid
    sdf : (nx, ny, nz) float32, in [-1, 1], positive in empty space, negative inside
    seen : (nx, ny, nz) uint8, the number of views that see the voxel, in front of their surface or behind it
    """

    grid: VoxelGrid
    sdf: np.ndarray
    seen: np.ndarray


def write_volume(path: Path, volume: Volume, header: Mapping[str, Any]) -> None:
    """Write a volume."""
    write_arrays(
        path,
        VOLUME,
        {"sdf": volume.sdf, "seen": volume.seen},
        header,
        {"sdf": {"sign": "positive in empty space", "unit": "clip distance"}},
        axes="x, y, z",
        **describe_grid(volume.grid),
    )


def read_volume(path: Path) -> Volume:
    """Read a volume."""
    arrays, attributes = read_arrays(path, VOLUME)
    return Volume(grid_of(attributes, arrays["sdf"].shape), arrays["sdf"], arrays["seen"])


def write_support(path: Path, support: Support, header: Mapping[str, Any]) -> None:
    """Write support.json."""
    content = {
        "unit": "scene unit",
        "plane": {"normal": support.plane.normal.tolist(), "offset": float(support.plane.offset)},
        "box": {name: getattr(support.box, name).tolist() for name in ("axes", "low", "high")},
        "figures": dict(support.figures),
    }
    write_document(path, SUPPORT, content, header)


def read_support(path: Path) -> Support:
    """Read support.json."""
    content = read_document(path, SUPPORT)
    plane = Plane(np.array(content["plane"]["normal"]), content["plane"]["offset"])
    box = Box(*(np.array(content["box"][name]) for name in ("axes", "low", "high")))
    return Support(plane, box, content["figures"])


def write_silhouettes(path: Path, silhouettes: Mapping[str, np.ndarray], header: Mapping[str, Any]) -> None:
    """Write masks (H, W) bool by view name."""
    write_arrays(path, SILHOUETTES, silhouettes, header, {name: {"axes": "row, column"} for name in silhouettes})


def read_silhouettes(path: Path) -> dict[str, np.ndarray]:
    """Read masks (H, W) bool by view name, sorted by name."""
    return dict(sorted(read_arrays(path, SILHOUETTES)[0].items()))
