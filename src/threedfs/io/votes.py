"""What the keyframes say in fusion, read one at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import overload

import numpy as np

from threedfs.io.consistency import ConsistencyStore
from threedfs.io.depth_maps import read_depth_map
from threedfs.types import Keyframe, View


@overload
def read_votes(
    keyframes: Mapping[str, Keyframe], depth: Sequence[Path], consistency: ConsistencyStore
) -> Iterator[tuple[View, np.ndarray, np.ndarray, np.ndarray]]:
    """With consistency all four are there."""


@overload
def read_votes(
    keyframes: Mapping[str, Keyframe], depth: Sequence[Path], consistency: ConsistencyStore | None
) -> Iterator[tuple[View, np.ndarray, np.ndarray | None, np.ndarray | None]]:
    """Without it the last two may be None."""


def read_votes(
    keyframes: Mapping[str, Keyframe], depth: Sequence[Path], consistency: ConsistencyStore | None
) -> Iterator[tuple[View, np.ndarray, np.ndarray | None, np.ndarray | None]]:
    """Yield the view, depth map, confidence and free depth of each keyframe; without consistency the last two are None.

    Parameters
    ----------
    keyframes : mapping of str to Keyframe
    depth : sequence of Path
        Depth maps, each named by its keyframe.
    consistency : ConsistencyStore or None
    """
    for path in depth:
        name = path.name.removesuffix(".zarr.zip")
        trust = consistency.read(name) if consistency else None
        yield (
            keyframes[name].view,
            read_depth_map(path).depth,
            trust.confidence if trust else None,
            trust.free_depth if trust else None,
        )
