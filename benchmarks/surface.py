"""Cost of the surface, against plain fusion and a plain hull of the same grid, and its peak memory.

    python benchmarks/surface.py [--longest 200] [--keyframes 20] [--masks 60]

A ball on a table, its depth and masks exact. Each kind of work runs in a process of its own, so that peak memory is its
own. Prints times, memory and ratios: of the whole surface to the fusion of the same depth alone, and of the hull that
lets some masks be wrong to a plain intersection of all masks by matrix products.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time

import numba
import numpy as np

from threedfs.fusion.fuse import VoteRule, start_fusion
from threedfs.fusion.softmax import SoftMaximum
from threedfs.geometry.grid import cover_box, voxel_places
from threedfs.geometry.projection import backproject_map
from threedfs.geometry.rigid import look_at
from threedfs.hull.distance import measure_hull
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule
from threedfs.params.surface import SurfaceParams
from threedfs.surface.complete import HullRule
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.surface.shape import ShapeRule, shape_surface
from threedfs.types import Box, Camera, Plane, View, VoxelGrid

CAMERA = Camera(640, 480, 900.0, 900.0, 319.5, 239.5)
CENTRE = np.array([0.0, 0, 0.25])
RADIUS = 0.3
TABLE = Plane(np.array([0.0, 0, 1]), 0.0)
CLIP = 8
"""Voxels."""


def circle(count: int) -> dict[str, View]:
    """Place views on a circle that look at the ball from above."""
    angles = 2 * np.pi * np.arange(count) / count
    centres = np.stack([np.cos(angles), np.sin(angles), np.full(count, 0.7)], axis=1) * 1.3
    poses = [look_at(centre, CENTRE, TABLE.normal) for centre in centres]
    return {str(rank): View(str(rank), CAMERA, pose) for rank, pose in enumerate(poses)}


def look(view: View) -> tuple[np.ndarray, np.ndarray]:
    """Return the depth (H, W) of ball and table, and the mask (H, W) bool of the ball, whose cap is under the table."""
    rays = backproject_map(view, np.ones(CAMERA.shape)) - view.centre
    table = np.where(rays[..., 2] < 0, -view.centre[2] / rays[..., 2], np.nan)
    apart = view.centre - CENTRE
    square, linear = (rays**2).sum(-1), rays @ apart
    rest = linear**2 - square * (apart @ apart - RADIUS**2)
    ball = np.where(rest > 0, (-linear - np.sqrt(np.maximum(rest, 0))) / square, np.nan)
    mask = ball < np.where(np.isnan(table), np.inf, table)
    return np.where(mask, ball, table), mask


def plain_hull(grid: VoxelGrid, views: dict[str, View], masks: dict[str, np.ndarray]) -> np.ndarray:
    """Return the voxels that lie inside of all masks: each view's projection is a matrix product."""
    points = voxel_places(grid, np.arange(np.prod(grid.shape)))
    inside = np.ones(len(points), bool)
    for name, view in views.items():
        matrix = view.px_from_world
        pixel = points @ matrix[:, :3].T + matrix[:, 3]
        column, row = (np.rint(pixel[:, axis] / pixel[:, 2]).astype(np.int64) for axis in (0, 1))
        shown = (row >= 0) & (column >= 0) & (row < CAMERA.height) & (column < CAMERA.width)
        inside[shown] &= masks[name][row[shown], column[shown]]
    return inside.reshape(grid.shape)


def work(kind: str, longest: int, keyframes: int, masks: int) -> None:
    """Do one kind of work once on a small grid, to compile, then measure it; print seconds of core and MB."""
    views, frames = circle(keyframes), circle(masks)
    depth = {name: look(view)[0] for name, view in views.items()}
    shown = {name: look(view)[1] for name, view in frames.items()}
    whole = {name: np.ones(CAMERA.shape, bool) for name in frames}
    trust = {name: np.ones(CAMERA.shape, np.float32) for name in views}
    params = SurfaceParams()
    shaping = make_rule(ShapeRule, params, complete=make_rule(HullRule, params))
    reach = RADIUS * 1.2

    def fuse(grid: VoxelGrid) -> SoftMaximum:
        vote = make_rule(VoteRule, FuseObjectParams())
        fused = start_fusion(grid, CLIP * grid.spacing, vote, hidden_distance=2 * grid.spacing)
        fused.add_all((view, depth[name], trust[name]) for name, view in views.items())
        return fused

    def act(grid: VoxelGrid) -> None:
        if kind == "fusion":
            fuse(grid).result()
        elif kind == "plain hull":
            plain_hull(grid, frames, shown)
        elif kind == "hull":
            every, tolerances = np.ones(grid.shape, bool), (0.2, 0.15, 0.2)
            measure_hull(shown, frames, whole, grid, every, ramp=CLIP, tolerances=tolerances)
        else:
            confirmed = ConfirmedDepth(fuse(grid), CLIP * grid.spacing, 0.5, 0.0, views, trust, depth.__getitem__)
            surface = shape_surface(confirmed, TABLE, shown, frames, whole, shaping)
            assert surface is not None

    box = Box(np.eye(3), CENTRE - reach, CENTRE + reach)
    act(cover_box(box, 40))
    before, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    act(cover_box(box, longest))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(time.process_time() - start, peak / 1e3, (peak - before) / 1e3)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--longest", type=int, default=200, help="voxels along each side of the cubic grid")
    parser.add_argument("--keyframes", type=int, default=20, help="views with depth")
    parser.add_argument("--masks", type=int, default=60, help="views with a mask")
    parser.add_argument("--kind", help=argparse.SUPPRESS)
    options = parser.parse_args()
    sizes = [options.longest, options.keyframes, options.masks]
    if options.kind:
        numba.set_num_threads(1)
        work(options.kind, *sizes)
        return
    names = ("--longest", "--keyframes", "--masks")
    arguments = [text for pair in zip(names, map(str, sizes), strict=True) for text in pair]
    seconds = {}
    print(f"{sizes[0]}^3 voxels, {sizes[1]} depth maps, {sizes[2]} masks of {CAMERA.width}x{CAMERA.height}, one core")
    print(f"{'':>12} {'seconds':>8} {'peak, MB':>9} {'its own, MB':>12}")
    for kind in ("fusion", "surface", "plain hull", "hull"):
        command = [sys.executable, __file__, *arguments, "--kind", kind]
        printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
        seconds[kind] = float(printed[0])
        print(f"{kind:>12} {seconds[kind]:8.1f} {float(printed[1]):9.0f} {float(printed[2]):12.0f}")
    print(f"surface to fusion: {seconds['surface'] / seconds['fusion']:.1f}")
    print(f"hull to plain hull: {seconds['hull'] / seconds['plain hull']:.2f}")


if __name__ == "__main__":
    main()
