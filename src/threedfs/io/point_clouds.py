"""The semi-dense points of all keyframes, read one keyframe at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from threedfs.geometry.projection import backproject_map
from threedfs.io.depth_maps import read_semidense
from threedfs.types import Keyframe


def read_semidense_points(
    keyframes: Mapping[str, Keyframe], semidense: Sequence[Path], max_deviation: float
) -> Iterator[np.ndarray]:
    """Yield the world points (N, 3) float64 of each keyframe's semi-dense map.

    Parameters
    ----------
    keyframes : mapping of str to Keyframe
    semidense : sequence of Path
        Semi-dense maps, each named by its keyframe.
    max_deviation : float
        Points whose inverse depth has a larger relative standard deviation are left out.
    """
    for name, depth in _read_depths(semidense, max_deviation):
        yield backproject_map(keyframes[name].view, depth)[np.isfinite(depth)]


def read_semidense_maps(semidense: Sequence[Path], max_deviation: float) -> dict[str, np.ndarray]:
    """Return the depths (H, W) float64 of all semi-dense maps by keyframe, NaN where none is sure enough."""
    return dict(_read_depths(semidense, max_deviation))


def _read_depths(semidense, max_deviation):
    for path in semidense:
        measured = read_semidense(path)
        inverse = measured.inverse_depth.astype(np.float64)
        sure = (inverse > 0) & (np.sqrt(measured.variance) <= max_deviation * inverse)
        depth = np.full(inverse.shape, np.nan)
        depth[sure] = 1 / inverse[sure]
        yield path.name.removesuffix(".zarr.zip"), depth
