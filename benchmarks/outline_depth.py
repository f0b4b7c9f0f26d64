"""Measure how wrong dense depth is near the true outline of the object of rendered takes.

    python benchmarks/outline_depth.py results/NAME [results/NAME ...]

Of the pixels of the keyframes' crops that lie in the true mask, within a few pixels of its outline: the median error,
and the share that is wrong by more than 5 %, of those that have depth. Keyframes must have a true mask and a true depth
image (`keyframes_at_truth: true`). It tells detectors of edges apart, as smoothing breaks off where they find one.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from command import run_command
from exact_depth import read_true_depths

from threedfs.evaluate.rendering import sample_nearest
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.images import read_mask
from threedfs.run_end.film import find_film
from threedfs.segment.outline import depth_inside


def measure_outline(folder: Path, reach: float) -> np.ndarray:
    """Return the relative errors (N,) of depth in the true masks of a run, within `reach` pixels of their outlines."""
    errors, masks = [], find_film(folder) / "masks"
    for name, pixels, truth in read_true_depths(folder):
        inside = depth_inside(sample_nearest(read_mask(masks / f"{name}.png"), pixels, False))
        depth = read_depth_map(folder / f"06_depth/{name}.zarr.zip").depth
        near = (inside > 0) & (inside <= reach) & np.isfinite(truth) & np.isfinite(depth)
        errors.append(np.abs(depth[near] - truth[near]) / truth[near])
    return np.concatenate(errors)


def main() -> None:
    """Print a line for each of the folders named on the command line, and one of their means."""
    parser = argparse.ArgumentParser(description="Measure dense depth near the true outline of rendered objects.")
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--reach", type=float, default=5.0, help="pixels inside the outline")
    given = parser.parse_args()
    rows = []
    for folder in given.folders:
        errors = measure_outline(folder, given.reach)
        rows.append((100 * np.median(errors), 100 * np.mean(errors > 0.05)))
        print("| {} | {:.2f} %, {:.1f} % |".format(folder.name, *rows[-1]), flush=True)
    print("| mean | {:.2f} %, {:.1f} % |".format(*np.mean(rows, axis=0)))


if __name__ == "__main__":
    run_command(main)
