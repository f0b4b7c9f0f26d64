"""A voxel grid among the attributes of an artifact."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from threedfs.types import VoxelGrid


def describe_grid(grid: VoxelGrid) -> dict[str, Any]:
    """Return where a grid lies as plain values; its shape is that of the volumes on it."""
    return {
        "origin": [float(x) for x in grid.origin],
        "spacing": float(grid.spacing),
        "axes_world": [[float(x) for x in axis] for axis in grid.axes],
    }


def grid_of(attributes: Mapping[str, Any], shape: tuple[int, int, int]) -> VoxelGrid:
    """Return the grid of `describe_grid`'s values and a volume's shape."""
    origin, axes = np.array(attributes["origin"]), np.array(attributes["axes_world"])
    return VoxelGrid(origin, attributes["spacing"], shape, axes)
