"""Cost of fusion: nanoseconds per voxel and view, and peak memory, for one core and for all.

Run: python benchmarks/fusion.py [--longest 200] [--views 12]
"""

from __future__ import annotations

import argparse
import resource
import time

import numba
import numpy as np

from threedfs.fusion.consistency import ComparisonRule, check_consistency
from threedfs.fusion.softmax import SoftMaximum, estimate_fusion_memory
from threedfs.geometry.grid import cover_box
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.types import Box, Camera, View

CAMERA = Camera(640, 480, 525.0, 525.0, 319.5, 239.5)
UP = np.array([0.0, 0, 1])


def circle(count: int) -> list[View]:
    """Place views on a circle that look at the origin from above."""
    angles = 2 * np.pi * np.arange(count) / count
    centres = np.stack([np.cos(angles), np.sin(angles), np.full(count, 0.7)], axis=1)
    return [View(str(i), CAMERA, look_at(centre, np.zeros(3), UP)) for i, centre in enumerate(centres)]


def table_depth(view: View) -> np.ndarray:
    """Return the depth of the plane z = 0, waved a little so that no branch is taken everywhere."""
    rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre
    depth = -view.centre[2] / rays[..., 2]
    return np.where(depth > 0, depth * (1 + 0.01 * np.sin(np.arange(CAMERA.width) / 9)), np.nan)


def measure(views: list[View], depths: list[np.ndarray], longest: int, threads: int) -> list[tuple[float, float]]:
    """Return wall and core nanoseconds per voxel and view of fusion, then per pixel and pair of the consistency."""
    grid = cover_box(Box(np.eye(3), np.full(3, -0.4), np.full(3, 0.4)), longest)
    trust, free = np.ones(CAMERA.shape), np.full(CAMERA.shape, np.inf)
    fused = SoftMaximum(grid, 4 * grid.spacing, 10.0, distrust=40.0, discontinuity=0.02, threads=threads)
    start = _clocks()
    for view, depth in zip(views, depths, strict=True):
        fused.add(view, depth, trust, free)
    fusion = (_clocks() - start) / (np.prod(grid.shape) * len(views))
    start = _clocks()
    for _ in check_consistency(views, lambda rank: depths[rank], ComparisonRule(0.02, 32, 0.5), threads):
        pass
    consistency = (_clocks() - start) / (len(views) * (len(views) - 1) * depths[0].size)
    return [tuple(fusion * 1e9), tuple(consistency * 1e9)]


def _clocks() -> np.ndarray:
    return np.array([time.perf_counter(), time.process_time()])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--longest", type=int, default=200, help="voxels along each side of the cubic grid")
    parser.add_argument("--views", type=int, default=12)
    options = parser.parse_args()
    views = circle(options.views)
    depths = [table_depth(view) for view in views]
    measure(views[:2], depths[:2], 8, numba.config.NUMBA_NUM_THREADS)  # compile
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"{options.longest}^3 voxels, {options.views} views of {CAMERA.width}x{CAMERA.height}")
    print(f"{'threads':>8} {'fusion, ns/voxel/view':>26} {'consistency, ns/pixel/pair':>28}")
    for threads in sorted({1, numba.config.NUMBA_NUM_THREADS}):
        cells = [f"{wall:.1f} ({core:.1f} of cores)" for wall, core in measure(views, depths, options.longest, threads)]
        print(f"{threads:>8} {cells[0]:>26} {cells[1]:>28}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    estimate = estimate_fusion_memory((options.longest,) * 3, CAMERA.shape) / 1e6
    work = f"{peak - before:.0f} MB by the measured work"
    print(f"peak memory {peak:.0f} MB, {work}; estimated for fusion: {estimate:.0f} MB")


if __name__ == "__main__":
    main()
