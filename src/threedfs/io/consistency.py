"""How well the depth maps of a sequence agree: one artifact, read one keyframe at a time."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import zarr

from threedfs.io.arrays import open_arrays, writing_arrays
from threedfs.io.schema import Schema

CONSISTENCY = Schema("threedfs/consistency/2", "consistency")


@dataclass(frozen=True)
class ConsistencyMap:
    """The trust in one depth map and what it comes from.

    Attributes
    ----------
    confidence : (H, W) float32 in [0, 1], trust in the pixel's surface
    free_depth : (H, W) float32, scene units, depth up to which no other view has a surface on the pixel's ray
        (infinity where none has one in front of the pixel's own)
    agree, too_near, too_far : (H, W) uint8, numbers of views that confirm the depth or contradict it
    """

    confidence: np.ndarray
    free_depth: np.ndarray
    agree: np.ndarray
    too_near: np.ndarray
    too_far: np.ndarray


@dataclass(frozen=True)
class ConsistencyStore:
    """The consistency of a sequence on disk."""

    names: tuple[str, ...]
    group: zarr.Group

    def read(self, name: str) -> ConsistencyMap:
        """Read one keyframe."""
        return ConsistencyMap(
            **{key: np.asarray(self.group[f"{key}/{name}"][...]) for key in ConsistencyMap.__annotations__}
        )


def write_consistency(path: Path, maps: Iterable[tuple[str, ConsistencyMap]], header: Mapping[str, Any]) -> None:
    """Stream (keyframe, map) pairs to an artifact; never more than one is held. Keyframes may differ in size."""
    names: list[str] = []
    with writing_arrays(path, CONSISTENCY, header) as writer:
        for name, item in maps:
            for key, values in vars(item).items():
                writer.put(f"{key}/{name}", values, axes="row, column")
            names.append(name)
        writer.attributes["names"] = names


def read_consistency(path: Path) -> ConsistencyStore:
    """Open the consistency of a sequence; maps are read when asked for."""
    group = open_arrays(path, CONSISTENCY)
    return ConsistencyStore(tuple(group.attrs["names"]), group)
