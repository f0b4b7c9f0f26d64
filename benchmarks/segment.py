"""The joint cut, against the same energy with all nodes in the graph of every move.

    python benchmarks/segment.py [--longest 200] [--keyframes 20] [--superpixels 2000]

A ball on a table, its field with noise, superpixels linked with its surface; three expansion moves. Each runs in a
process of its own, so that peak memory is its own. Prints times, memory, their ratios, and whether labels are equal.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from maxflow import GraphFloat
from scipy import ndimage

from threedfs.segment.alpha_expansion import expand
from threedfs.segment.energy import BACKGROUND, EMPTY, OBJECT, fold_given
from threedfs.segment.initialise import UNDECIDED, fix_voxels, normalised_height
from threedfs.segment.pairwise import voxel_pairs
from threedfs.segment.unaries import scene_unary, sdf_unary

_HELD = 1e6
"""Cost that holds a given node at its label, and a node from a label that it may not have."""
_OPEN_SHARE = 0.1
"""Share of the superpixels in the band of the trimap."""


@dataclass(frozen=True)
class Problem:
    """Pairs (P, 2), weights (P,), labels (N,), which nodes are open (N,), and the costs (N, 3) of those, or of all."""

    unary: np.ndarray
    pairs: np.ndarray
    weight: np.ndarray
    labels: np.ndarray
    is_open: np.ndarray


def make_problem(side: int, keyframes: int, superpixels: int, whole: bool) -> Problem:
    """Return the energy and first labels; pairs and costs of given voxels only for the whole graph."""
    rng = np.random.default_rng(0)
    axis = np.linspace(-1, 1, side, dtype=np.float32)
    radius = np.sqrt(axis[:, None, None] ** 2 + axis[:, None] ** 2 + axis**2)
    height = np.broadcast_to(axis + 0.6, radius.shape).copy()
    noise = ndimage.gaussian_filter(rng.standard_normal(radius.shape, np.float32), 2)
    sdf = np.clip(np.minimum(radius - 0.55, height) / 0.1 + 2 * noise, -1, 1)
    normalised = normalised_height(height)
    fixed = fix_voxels(sdf, normalised, empty_level=0.9, deepest=0.4)
    first = np.where(fixed != UNDECIDED, fixed, np.where(sdf < 0, OBJECT, EMPTY)).reshape(-1)
    count = keyframes * superpixels
    band = rng.random(count) < _OPEN_SHARE
    is_open = np.concatenate([band, (fixed == UNDECIDED).reshape(-1)])
    unary = np.zeros((len(is_open), 3), np.float32)
    unary[:count, :2] = rng.random((count, 2)) * 5
    unary[:count, EMPTY] = np.inf
    unary[count:] = 4 * sdf_unary(sdf.reshape(-1)) + scene_unary(normalised.reshape(-1))
    surface = np.flatnonzero((np.abs(sdf) < 0.25).reshape(-1))
    links = np.stack([rng.integers(0, count, 5 * count), count + rng.choice(surface, 5 * count)], axis=1)
    beside = np.stack([np.arange(count - 1), np.arange(1, count)], axis=1)
    voxels = count + voxel_pairs(np.ones_like(fixed, bool) if whole else fixed == UNDECIDED)
    weights = [np.full(count - 1, 0.5), np.full(5 * count, 0.04), np.full(len(voxels), 0.3)]
    return Problem(
        unary if whole else unary[is_open],
        np.concatenate([beside, links, voxels], dtype=np.int32),
        np.concatenate(weights, dtype=np.float32),
        np.concatenate([rng.integers(0, 2, count), first]).astype(np.uint8),
        is_open,
    )


def cut_folded(problem: Problem) -> np.ndarray:
    """Return the labels after three moves of the project's expansion."""
    labels, is_open = problem.labels.copy(), problem.is_open
    graph = fold_given(problem.pairs, problem.weight, labels, is_open, 3).with_costs(problem.unary)
    for target in (BACKGROUND, OBJECT, EMPTY):
        labels[is_open] = expand(graph, labels[is_open], target)
    return labels


def cut_whole(problem: Problem) -> np.ndarray:
    """Return the labels after three moves with all nodes in the graph, given ones held by their costs."""
    labels, unary = problem.labels.copy(), np.minimum(problem.unary, _HELD)
    held = np.flatnonzero(~problem.is_open)
    unary[held] = _HELD
    unary[held, labels[held]] = 0
    one, other = problem.pairs.T
    for target in (BACKGROUND, OBJECT, EMPTY):
        keep = unary[np.arange(len(labels)), labels].astype(np.float64)
        take = unary[:, target].astype(np.float64)
        ours, theirs = ((labels[ends] != target) * problem.weight for ends in (one, other))
        apart = (labels[one] != labels[other]) * problem.weight
        # both keep: apart, one keeps: ours or theirs, none: 0; as costs of keeping and an edge
        between = (ours + theirs - apart) / 2
        keep += np.bincount(one, ours - between, len(labels)) + np.bincount(other, theirs - between, len(labels))
        graph = GraphFloat(len(labels), len(one))
        ids = graph.add_grid_nodes(len(labels))
        graph.add_edges(one, other, between, between)
        graph.add_grid_tedges(ids, take, keep)
        graph.maxflow()
        labels[graph.get_grid_segments(ids)] = target
    return labels


def measure(side: int, keyframes: int, superpixels: int, cut: Callable[[Problem], np.ndarray]) -> None:
    """Print seconds, peak memory in MB, open nodes and a checksum of the labels."""
    cut(make_problem(16, 2, 50, cut is cut_whole))  # compiles
    problem = make_problem(side, keyframes, superpixels, cut is cut_whole)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    start = time.perf_counter()
    labels = cut(problem)
    seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(seconds, peak, peak - before, int(problem.is_open.sum()), zlib.crc32(labels.tobytes()))


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--longest", type=int, default=200, help="voxels along each side of the cubic grid")
    parser.add_argument("--keyframes", type=int, default=20)
    parser.add_argument("--superpixels", type=int, default=2000, help="of each keyframe")
    parser.add_argument("--only", choices=("folded", "whole"), help="run one of both in this process")
    options = parser.parse_args()
    size = (options.longest, options.keyframes, options.superpixels)
    if options.only:
        measure(*size, cut_folded if options.only == "folded" else cut_whole)
        return
    command = [sys.executable, __file__, *(f"--{k}={v}" for k, v in vars(options).items() if v is not None)]
    found = {}
    for name in ("folded", "whole"):
        out = subprocess.run([*command, f"--only={name}"], capture_output=True, text=True, check=True).stdout
        found[name] = [float(value) for value in out.split()]
        seconds, peak, own, nodes, _ = found[name]
        print(f"{name}: {seconds:.1f} s for three moves, peak {peak:.0f} MB ({own:.0f} by the cut), {nodes:.0f} nodes")
    ours, whole = found["folded"], found["whole"]
    print(f"{whole[0] / ours[0]:.1f} times faster, {ours[1] / whole[1]:.2f} of the peak memory", end=", ")
    print(f"{ours[2] / whole[2]:.2f} of what the cut takes", end=", ")
    print("equal labels" if ours[4] == whole[4] else "DIFFERENT labels")


if __name__ == "__main__":
    main()
