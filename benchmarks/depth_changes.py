"""Measure what changes to settings of `depth` do to the depth maps of rendered takes.

    python benchmarks/depth_changes.py results/NAME [results/NAME ...] --change KEY=VALUE[,KEY=VALUE ...] ...

Takes a finished run of a rendered take with `keyframes_at_truth: true`. Makes the depth maps of a few keyframes, evenly
spread, as they were made, and with each change, and compares them with true depth within the true masks: the median
error, and the shares that are wrong by more than 2 and 5 %, of the pixels that have depth.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from command import run_command
from exact_cuts import read_settings, read_true_masks
from exact_depth import read_true_depths

from threedfs.io.arrays import read_arrays
from threedfs.io.depth_maps import DEPTH_MAP, read_depth_map
from threedfs.job import Job
from threedfs.params.depth import DepthParams
from threedfs.params.schema import make_params
from threedfs.progress import Progress
from threedfs.stages import depth


def make_depth(folder: Path, keyframe: str, changes: Mapping[str, Any]) -> np.ndarray:
    """Return the depth map (H, W) float32 of a keyframe, made by the run's settings but for `changes`."""
    params = read_arrays(folder / f"06_depth/{keyframe}.zarr.zip", DEPTH_MAP)[1]["parameters"] | changes
    stereo = folder / f"05_stereo_checked/{keyframe}.zarr.zip"
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "depth.zarr.zip"
        depth.run(
            crops=folder / "04_crops/crops.zarr.zip",
            keyframes=folder / "04_crops/keyframes.json",
            semidense=folder / f"04_semidense/{keyframe}.zarr.zip",
            edges=folder / f"05_edges/{keyframe}.zarr.zip",
            stereo=stereo if stereo.exists() else None,
            depth=path,
            keyframe=keyframe,
            params=make_params(DepthParams, params),
            job=Job(Progress("depth"), {}, 1, 0),
        )
        return read_depth_map(path).depth


def read_truths(folder: Path, count: int) -> dict[str, np.ndarray]:
    """Return the true depth (H, W) of `count` keyframes, evenly spread, in scene units; NaN off the object."""
    masks, truths = read_true_masks(folder), list(read_true_depths(folder))
    chosen = [truths[at] for at in np.linspace(0, len(truths) - 1, count).round().astype(int)]
    return {name: np.where(masks[name], truth, np.nan) for name, _, truth in chosen}


def measure_change(
    folder: Path, truths: Mapping[str, np.ndarray], changes: Mapping[str, Any]
) -> tuple[float, float, float]:
    """Return the median error and the shares wrong by more than 2 and 5 %, all in %, over some keyframes."""
    errors = []
    for name, truth in truths.items():
        made = make_depth(folder, name, changes)
        both = np.isfinite(truth) & np.isfinite(made)
        errors.append(np.abs(made[both] - truth[both]) / truth[both])
    error = 100 * np.concatenate(errors)
    return float(np.median(error)), 100 * float(np.mean(error > 2)), 100 * float(np.mean(error > 5))


def main() -> None:
    """Print a line for each folder and change."""
    parser = argparse.ArgumentParser(description="Measure what changes to settings of depth do to depth maps.")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--change", nargs="+", default=[], metavar="KEY=VALUE[,KEY=VALUE]")
    parser.add_argument("--keyframes", type=int, default=3, help="keyframes of a take, evenly spread")
    given = parser.parse_args()
    for folder in given.folders:
        truths = read_truths(folder, given.keyframes)
        for change in ["", *given.change]:
            found = measure_change(folder, truths, read_settings(change.split(",") if change else []))
            print(
                "| {} | {} | {:.2f} % | {:.1f} % | {:.1f} % |".format(folder.name, change or "as it is", *found),
                flush=True,
            )


if __name__ == "__main__":
    run_command(main)
