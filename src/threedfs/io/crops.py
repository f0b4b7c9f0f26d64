"""Crops: images of their own sizes, without distortion, with the pixels that show the scene."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from threedfs.io.arrays import open_arrays, writing_arrays
from threedfs.io.schema import Schema

CROPS = Schema("threedfs/crops/1", "crops or shrink")


@dataclass(frozen=True)
class Crop:
    """One resampled image.

    Attributes
    ----------
    name : str
        Of the frame.
    image : (H, W, 3) uint8 RGB
    valid : (H, W) bool
        Pixels that show the scene.
    """

    name: str
    image: np.ndarray
    valid: np.ndarray


@dataclass(frozen=True)
class CropStore:
    """The crops of a sequence on disk, read when asked for.

    Attributes
    ----------
    names : tuple of str
    ordered : bool
        Whether they come from a video.
    source_shape : tuple
        (H, W) of the frames as filmed.
    """

    names: tuple[str, ...]
    ordered: bool
    source_shape: tuple[int, int]
    arrays: zarr.Group

    def image(self, name: str) -> np.ndarray:
        """Read one image, (H, W, 3) uint8 RGB."""
        return np.asarray(self.arrays[f"images/{name}"][...])

    def valid_of(self, name: str) -> np.ndarray:
        """Read which pixels of one image show the scene, (H, W) bool."""
        return np.asarray(self.arrays[f"valid/{name}"][...])


def write_crops(
    path: Path, crops: Iterable[Crop], header: Mapping[str, Any], *, ordered: bool, source_shape: tuple[int, int]
) -> None:
    """Stream crops to an artifact; never more than one is held."""
    names = []
    with writing_arrays(path, CROPS, header) as writer:
        for crop in crops:
            writer.put(f"images/{crop.name}", crop.image, axes="row, column, RGB")
            writer.put(f"valid/{crop.name}", crop.valid, axes="row, column")
            names.append(crop.name)
        writer.attributes.update(names=names, ordered=ordered, source_shape=list(source_shape))


def read_crops(path: Path) -> CropStore:
    """Open the crops of a sequence; images are read when asked for."""
    group = open_arrays(path, CROPS)
    attributes = group.attrs
    return CropStore(tuple(attributes["names"]), bool(attributes["ordered"]), tuple(attributes["source_shape"]), group)
