"""Keypoints of all frames."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.types import Features

FEATURES = Schema("threedfs/features/1", "features")


def write_features(path: Path, features: Sequence[Features], header: Mapping[str, Any]) -> None:
    """Write the keypoints of every frame, in the order of the frames."""
    arrays = {name: np.concatenate([getattr(frame, name) for frame in features]) for name in vars(features[0])}
    arrays["frame"] = np.repeat(np.arange(len(features)), [len(frame.pixels) for frame in features])
    notes = {"pixels": {"axes": "point, (u, v)", "unit": "px"}, "frame": {"meaning": "number of the frame, ascending"}}
    write_arrays(path, FEATURES, arrays, header, notes, frames=len(features))


def read_features(path: Path) -> list[Features]:
    """Read the keypoints of every frame."""
    arrays, attributes = read_arrays(path, FEATURES)
    ends = np.searchsorted(arrays.pop("frame"), np.arange(attributes["frames"] + 1))
    return [Features(**{name: array[first:last] for name, array in arrays.items()}) for first, last in pairwise(ends)]
