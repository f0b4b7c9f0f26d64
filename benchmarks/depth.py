"""Dense depth of one keyframe against a plain reference, in one run.

    python benchmarks/depth.py [--iterations N] [--height 480 --width 640]

A textured hemisphere on a slanted plane with a blank patch, 10 neighbours, 64 candidates. The reference computes
the same cost volume with cv2 warps and box filters, the same search with numpy, and solves the linear system of
each iteration with scipy.sparse.linalg.spsolve; both solve every system to 1e-6 or better. The reference's time
for N iterations is that of the cost volume, N searches and N + 1 solves. Prints times, their ratio, the largest
and median relative difference of depth, and the peak memory of our part, measured in a process of its own.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import time

import cv2
import numpy as np
import scipy.sparse as sparse
from scene import make_scene
from scipy.sparse.linalg import spsolve

from threedfs.depth.bending import HALF_OFFSETS, assemble_prior
from threedfs.depth.candidates import space_candidates
from threedfs.depth.cost_volume import compute_cost_volume, plane_homographies
from threedfs.depth.solver import optimise_depth
from threedfs.depth.weights import coupling_schedule, photometric_confidence, smoothness_at
from threedfs.depth.zncc import MISSING
from threedfs.params.depth import DepthParams
from threedfs.types import View

FLOOR, MISSING_COST = 2.0, 0.5
SETTINGS = dict(
    prior="rotation_invariant",
    photometric_weight=100.0,
    coupling=1.0,
    coupling_decay=0.1,
    median_size=3,
    newton_rate=0.0,
    smoothness=1.0,
    smoothness_growth=2.6,
    break_bending=0.0,
    tolerance=1e-6,
    early_tolerance=1e-6,
    max_steps=200,
)


def run_ours(height: int, width: int, iterations: int, fine_iterations: int = 0) -> tuple[np.ndarray, float, float]:
    """Return depth, seconds, and peak memory in MB; all iterations are at full resolution if not told how many."""
    cv2.setNumThreads(1)
    for shape in ((60, 80), (height, width)):  # the first compiles
        views, images = make_scene(*shape)
        start = time.perf_counter()
        candidates = space_candidates(0.6, 1.8, 64, "inverse")
        cost = compute_cost_volume(
            views[0],
            images["0"],
            views[1:],
            lambda view, images=images: images[view.name],
            candidates,
            patch_radius=1,
            variance_floor=FLOOR,
            missing_cost=MISSING_COST,
        )
        confidence = photometric_confidence(cost.min(0).astype(float), 10.0)
        nothing, ones = np.zeros(shape), np.ones(shape)
        solution = optimise_depth(
            cost,
            candidates,
            confidence,
            nothing,
            nothing,
            ones,
            iterations=iterations,
            fine_iterations=fine_iterations or iterations,
            **SETTINGS,
        )
        seconds = time.perf_counter() - start
    return solution.depth, seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def reference_cost(views: list[View], images: dict[str, np.ndarray], candidates: np.ndarray) -> np.ndarray:
    """Eq. 1 with cv2 warps and box filters."""

    def box(image):
        return cv2.boxFilter(image, -1, (3, 3))

    grey = images["0"]
    mean = box(grey)
    variance = np.maximum(box(grey * grey) - mean * mean, 0) + FLOOR
    cost = np.zeros((len(candidates), *grey.shape), np.float32)
    for view in views[1:]:
        for index, homography in enumerate(plane_homographies(views[0], view, candidates)):
            warped = cv2.warpPerspective(
                images[view.name],
                homography,
                grey.shape[::-1],
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_CONSTANT,
                borderValue=float(MISSING),
            )
            missing = cv2.erode(warped, np.ones((3, 3))) < -1e4
            warped[warped < -1e4] = 0
            other = box(warped)
            spread = np.maximum(box(warped * warped) - other * other, 0) + FLOOR
            correlation = (box(grey * warped) - mean * other) / np.sqrt(variance * spread)
            cost[index] += np.where(missing, MISSING_COST, (1 - correlation) / 2)
    cost /= len(views) - 1
    cost[:, [0, -1]] = MISSING_COST
    cost[:, :, [0, -1]] = MISSING_COST
    return cost


def sparse_prior(height: int, width: int) -> sparse.csc_matrix:
    """The prior's matrix for scipy."""
    stencil = assemble_prior(np.ones((height, width)), SETTINGS["prior"])
    index = np.arange(height * width).reshape(height, width)
    rows, columns, values = [], [], []
    for k, (dv, du) in enumerate(HALF_OFFSETS):
        v, u = np.nonzero(stencil[k])
        here, there, value = index[v, u], index[v + dv, u + du], stencil[k, v, u]
        rows += [here] if k == 0 else [here, there]
        columns += [there] if k == 0 else [there, here]
        values += [value] if k == 0 else [value, value]
    size = height * width
    return sparse.csc_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (size, size))


def run_reference(height: int, width: int, iterations: int) -> tuple[np.ndarray, float]:
    """Return depth and seconds."""
    cv2.setNumThreads(1)
    views, images = make_scene(height, width)
    start = time.perf_counter()
    candidates = space_candidates(0.6, 1.8, 64, "inverse")
    cost = reference_cost(views, images, candidates)
    confidence = photometric_confidence(cost.min(0).astype(float), 10.0)
    prior = sparse_prior(height, width)
    schedule = coupling_schedule(SETTINGS["coupling"], SETTINGS["coupling_decay"], iterations)
    auxiliary = candidates[cost.argmin(0)]
    depth = auxiliary
    for iteration in range(iterations + 1):
        coupling = schedule[max(iteration - 1, 0)]
        if iteration:
            energy = SETTINGS["photometric_weight"] * cost + (candidates[:, None, None] - depth) ** 2 / (2 * coupling)
            auxiliary = candidates[energy.argmin(0)].astype(np.float32)
            auxiliary = cv2.medianBlur(auxiliary, SETTINGS["median_size"]).astype(float)
        smooth = smoothness_at(max(iteration, 1), SETTINGS["smoothness"], SETTINGS["smoothness_growth"])
        diagonal = (confidence / (2 * coupling)).ravel()
        matrix = smooth * prior + sparse.diags(diagonal)
        depth = spsolve(matrix.tocsc(), diagonal * auxiliary.ravel()).reshape(height, width)
        print(
            f"  reference: solve {iteration + 1} of {iterations + 1}, {time.perf_counter() - start:.0f} s", flush=True
        )
    return depth, time.perf_counter() - start


def main() -> None:
    """Run both and print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iterations", type=int, default=8)
    parser.add_argument("--height", type=int, default=480)
    parser.add_argument("--width", type=int, default=640)
    options = parser.parse_args()
    size = (options.height, options.width, options.iterations)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        depth, ours, memory = pool.apply(run_ours, size)
        default = pool.apply(run_ours, (*size, DepthParams.fine_iterations))[1]
    print(f"ours       {ours:8.1f} s, peak memory of the process {memory:.0f} MB", flush=True)
    print(f"           {default:8.1f} s with the first iterations at half the resolution, as by default", flush=True)
    expected, reference = run_reference(*size)
    difference = np.abs(depth / expected - 1)
    print(f"reference  {reference:8.1f} s")
    print(f"ratio      {reference / ours:8.1f}")
    median, tail = np.median(difference), np.percentile(difference, 99)
    print(f"relative difference of depth: median {median:.1e}, 99 % below {tail:.1e}")


if __name__ == "__main__":
    main()
