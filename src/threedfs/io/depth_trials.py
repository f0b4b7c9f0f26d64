"""Depth maps of one keyframe by several methods, beside the truth: one keyframe of the depth experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from threedfs.io.arrays import read_arrays, write_arrays
from threedfs.io.schema import Schema

DEPTH_TRIAL = Schema("threedfs/depth-trial/1", "depth_trial")


@dataclass(frozen=True)
class DepthTrial:
    """Depth maps in the unit of the true cameras, camera-frame z.

    Attributes
    ----------
    methods : tuple of str
        Name of each map: how, and from how many measurements (``rotation_invariant/100``).
    depth : (M, H, W) float32
    truth : (H, W) float32, NaN where unknown
    on_object : (H, W) bool, false everywhere if no truth tells where the object is
    measured : (N, 2) int64, (row, column) of the depths drawn from the truth; a method with n was given the first n
    """

    methods: tuple[str, ...]
    depth: np.ndarray
    truth: np.ndarray
    on_object: np.ndarray
    measured: np.ndarray


def write_depth_trial(path: Path, trial: DepthTrial, header: Mapping[str, Any]) -> None:
    """Write a trial."""
    unit = {"unit": "unit of the true cameras"}
    arrays = {name: getattr(trial, name) for name in ("depth", "truth", "on_object", "measured")}
    notes = {"depth": {**unit, "axes": "method, row, column"}, "truth": unit}
    write_arrays(path, DEPTH_TRIAL, arrays, header, notes, methods=list(trial.methods))


def read_depth_trial(path: Path) -> DepthTrial:
    """Read a trial."""
    arrays, attributes = read_arrays(path, DEPTH_TRIAL)
    return DepthTrial(methods=tuple(attributes["methods"]), **arrays)
