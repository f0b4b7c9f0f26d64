"""Labels of superpixels' pixels and of voxels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.grids import describe_grid, grid_of
from threedfs.io.schema import Schema
from threedfs.types import VoxelGrid

SEGMENTATION = Schema("threedfs/segmentation/2", "segment, spectral_matting or volumetric_cut")

_MASK = "mask_"


@dataclass(frozen=True)
class Segmentation:
    """The outcome of a cut.

    Attributes
    ----------
    masks : mapping of str to (H, W) bool
        The object in each undistorted keyframe; empty where only voxels were labelled.
    grid : VoxelGrid
    voxels : (nx, ny, nz) uint8
        Background 0, object 1, empty 2; of no voxels where only images were labelled.
    energies : (M,) float64
        After each move.
    swaps : (M,) int64
        Labels that each move changed.
    """

    masks: Mapping[str, np.ndarray]
    grid: VoxelGrid
    voxels: np.ndarray
    energies: np.ndarray
    swaps: np.ndarray


def write_segmentation(path: Path, segmentation: Segmentation, header: Mapping[str, Any]) -> None:
    """Write a segmentation."""
    masks = {_MASK + name: mask for name, mask in sorted(segmentation.masks.items())}
    arrays = {"voxels": segmentation.voxels, "energies": segmentation.energies, "swaps": segmentation.swaps, **masks}
    write_arrays(
        path,
        SEGMENTATION,
        arrays,
        header,
        {"voxels": {"axes": "x, y, z", "labels": "background 0, object 1, empty 2"}},
        **describe_grid(segmentation.grid),
    )


def read_segmentation(path: Path) -> Segmentation:
    """Read a segmentation."""
    arrays, attributes = read_arrays(path, SEGMENTATION)
    masks = {name.removeprefix(_MASK): mask for name, mask in sorted(arrays.items()) if name.startswith(_MASK)}
    voxels = arrays["voxels"]
    return Segmentation(masks, grid_of(attributes, voxels.shape), voxels, arrays["energies"], arrays["swaps"])
