"""Per-keyframe maps: semi-dense depth, edge strength, stereo patches, dense depth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema

DEPTH_MAP = Schema("threedfs/depth-map/1", "depth")
EDGES = Schema("threedfs/edges/1", "cues or depth_trial")
SEMIDENSE = Schema("threedfs/semidense/1", "cues")
STEREO = Schema("threedfs/stereo/1", "stereo or stereo_check")


@dataclass(frozen=True)
class Semidense:
    """Inverse depth and its variance at high-gradient pixels.

    Attributes
    ----------
    inverse_depth : (H, W) float32, 1 / scene unit, NaN where there is none
    variance : (H, W) float32, of the inverse depth, NaN where there is none
    """

    inverse_depth: np.ndarray
    variance: np.ndarray


@dataclass(frozen=True)
class StereoMap:
    """Slanted patches that match in other views.

    Attributes
    ----------
    inverse_depth : (H, W) float32, 1 / scene unit, NaN where there is none
    slope : (H, W, 2) float32, its change per pixel along columns and rows
    cost : (H, W) float32, (1 - NCC) / 2 over the views that match best
    """

    inverse_depth: np.ndarray
    slope: np.ndarray
    cost: np.ndarray


@dataclass(frozen=True)
class DepthMap:
    """A dense depth map.

    Attributes
    ----------
    depth : (H, W) float32, camera-frame z in scene units, NaN outside the valid image
    min_cost : (H, W) float32, least photometric error over the candidates, in [0, 1] (Eq. 12)
    confidence : (H, W) float32, how much the photometric error speaks for the depth, in [0, 1] (Eq. 11)
    """

    depth: np.ndarray
    min_cost: np.ndarray
    confidence: np.ndarray


def write_semidense(path: Path, semidense: Semidense, header: Mapping[str, Any]) -> None:
    """Write a semi-dense map."""
    notes = {"inverse_depth": {"unit": "1 / scene unit"}, "variance": {"unit": "1 / scene unit^2"}}
    write_arrays(path, SEMIDENSE, vars(semidense), header, notes, axes="row, column")


def read_semidense(path: Path) -> Semidense:
    """Read a semi-dense map."""
    return Semidense(**read_arrays(path, SEMIDENSE)[0])


def write_edges(path: Path, strength: np.ndarray, header: Mapping[str, Any]) -> None:
    """Write edge strength, (H, W) float32 in [0, 1]."""
    write_arrays(path, EDGES, {"strength": strength}, header, axes="row, column")


def read_edges(path: Path) -> np.ndarray:
    """Read edge strength, (H, W) float32 in [0, 1]."""
    return read_arrays(path, EDGES)[0]["strength"]


def write_stereo(path: Path, stereo: StereoMap, header: Mapping[str, Any]) -> None:
    """Write slanted patches."""
    notes = {"inverse_depth": {"unit": "1 / scene unit"}, "slope": {"unit": "1 / (scene unit px)", "axes": "u, v"}}
    write_arrays(path, STEREO, vars(stereo), header, notes, axes="row, column")


def read_stereo(path: Path) -> StereoMap:
    """Read slanted patches."""
    return StereoMap(**read_arrays(path, STEREO)[0])


def write_depth_map(path: Path, depth_map: DepthMap, header: Mapping[str, Any], **figures: Any) -> None:
    """Write a dense depth map; `figures` (solver residuals, ...) become attributes."""
    notes = {"depth": {"unit": "scene unit", "meaning": "camera-frame z, NaN where unknown"}}
    write_arrays(path, DEPTH_MAP, vars(depth_map), header, notes, axes="row, column", **figures)


def read_depth_map(path: Path) -> DepthMap:
    """Read a dense depth map."""
    return DepthMap(**read_arrays(path, DEPTH_MAP)[0])
