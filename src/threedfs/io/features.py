"""Keypoints of the frames that they were looked for in."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema
from threedfs.types import Features

FEATURES = Schema("threedfs/features/2", "features")


def write_features(path: Path, features: Mapping[int, Features], header: Mapping[str, Any]) -> None:
    """Write keypoints by frame number, ascending."""
    frames = list(features.values())
    arrays = {name: np.concatenate([getattr(frame, name) for frame in frames]) for name in vars(frames[0])}
    arrays["frame"] = np.array(list(features), np.int64)
    arrays["count"] = np.array([len(frame.pixels) for frame in frames], np.int64)
    notes = {
        "pixels": {"axes": "point, (u, v)", "unit": "px"},
        "frame": {"meaning": "numbers of the frames that keypoints were looked for in, ascending"},
        "count": {"meaning": "keypoints of each of these frames"},
    }
    write_arrays(path, FEATURES, arrays, header, notes)


def read_features(path: Path) -> dict[int, Features]:
    """Read keypoints by frame number; frames that none were looked for in are absent."""
    arrays, _ = read_arrays(path, FEATURES)
    frames, ends = arrays.pop("frame"), np.cumsum(arrays.pop("count"))
    return {
        int(frame): Features(**{name: array[first:last] for name, array in arrays.items()})
        for frame, first, last in zip(frames, [0, *ends[:-1]], ends, strict=True)
    }
