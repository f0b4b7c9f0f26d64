"""Dense evaluation of a sum of Gaussian radial basis functions against a direct loop, in one run.

    python benchmarks/deform.py [--longest 200] [--centres 4000] [--loop-share 0.02]

The loop is compact, compiled by numba and takes all pairs of voxel and centre; it runs on a share of the grid and its
time is scaled up. Prints times, their ratio, the largest difference, and the peak memory of our part.
"""

from __future__ import annotations

import argparse
import resource
import time

import numpy as np
from numba import njit

from threedfs.deform.rbf import evaluate_on_grid
from threedfs.types import VoxelGrid

WIDTH = 0.1


@njit
def sum_directly(x, y, z, centres, coefficients, width):
    """Sum over all pairs, one exponential each."""
    field = np.zeros((len(x), len(y), len(z)))
    for i in range(len(x)):
        for j in range(len(y)):
            for k in range(len(z)):
                total = 0.0
                for c in range(len(centres)):
                    dx, dy, dz = x[i] - centres[c, 0], y[j] - centres[c, 1], z[k] - centres[c, 2]
                    total += coefficients[c] * np.exp(-(dx * dx + dy * dy + dz * dz) / (width * width))
                field[i, j, k] = total
    return field


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--longest", type=int, default=200, help="voxels along each side of the cubic grid")
    parser.add_argument("--centres", type=int, default=4000)
    parser.add_argument("--loop-share", type=float, default=0.02, help="share of the grid that the loop runs on")
    options = parser.parse_args()
    side = options.longest
    grid = VoxelGrid(np.zeros(3), 1 / side, (side, side, side))
    rng = np.random.default_rng(0)
    centres, coefficients = rng.random((options.centres, 3)), rng.normal(size=options.centres)
    evaluate_on_grid(VoxelGrid(np.zeros(3), 0.1, (10, 10, 10)), centres, coefficients, WIDTH)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    start = time.perf_counter()
    field = evaluate_on_grid(grid, centres, coefficients, WIDTH)
    ours = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    slabs = max(1, round(options.loop_share * side))
    axes = [np.arange(side) / side] * 3
    sum_directly(axes[0][:1], axes[1][:2], axes[2][:2], centres, coefficients, WIDTH)
    start = time.perf_counter()
    direct = sum_directly(axes[0][:slabs], axes[1], axes[2], centres, coefficients, WIDTH)
    loop = (time.perf_counter() - start) * side / slabs
    error = np.abs(field[:slabs] - direct).max()
    print(f"{side}^3 voxels, {options.centres} centres")
    print(
        f"product of matrices {ours:.2f} s, direct loop {loop:.1f} s ({slabs} slabs, scaled): {loop / ours:.0f} times"
    )
    print(f"largest difference {error:.1e}, peak {peak:.0f} MB ({peak - before:.0f} by the sum)")


if __name__ == "__main__":
    main()
