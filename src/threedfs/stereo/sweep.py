"""Numba kernels that improve the planes of a patch match: spreading, guessing, refining.

`views` is (images, infinity, epipole) of the neighbours, `rule` (offsets, falloff, variance_floor, least_variance,
best_views): how a patch is sampled and compared.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.stereo.slanted_patch import disparity_rate, faces_camera, patch_cost, weigh_patch

_UNMATCHED = 0.6  # planes that cost more are not worth spreading


@njit(cache=True)
def improve_planes(grey, wanted, views, rule, planes, cost, depth_range, focal, spread, guess, scale, colour, seed):
    """Improve the planes of one colour of the checkerboard in place: by those of the other, and by small changes.

    Parameters
    ----------
    grey : (H, W) float32
    wanted : (H, W) bool
        Pixels whose planes are improved; those of the others may still be spread.
    views, rule : tuples
    planes, cost : (H, W, 3) and (H, W) float64
        Changed in place; cost is infinity where a plane was not compared yet.
    depth_range : (least, most) inverse depth
    focal : float, pixels
    spread : (N, 2) int64
        Where, beside a pixel, planes are taken from.
    guess : bool
        Whether planes at random are tried too.
    scale : float
        How large changes are, 1 at first.
    colour : {0, 1}
    seed : uint64
    """
    height, width = grey.shape
    offsets, falloff, variance_floor, least_variance, _ = rule
    least, most = depth_range
    patch = (np.empty(offsets.shape[1], np.float32), np.empty(offsets.shape[1], np.float32))
    costs = np.empty(len(views[0]))
    trial = np.empty(3)
    kept = np.empty(3)
    for v in range(height):
        for u in range((v + colour) % 2, width, 2):
            if not wanted[v, u]:
                continue
            deviation = weigh_patch(grey, u, v, offsets, falloff, variance_floor, least_variance, patch)
            if deviation == 0:
                continue
            kept[:] = planes[v, u]
            lowest = cost[v, u]
            if lowest == np.inf:
                lowest = 1.0
                if faces_camera(kept, focal, least, most):
                    lowest = patch_cost(views, rule, u, v, kept, patch, deviation, costs)
            for i in range(len(spread)):
                x = u + spread[i, 0]
                y = v + spread[i, 1]
                if x < 0 or y < 0 or x >= width or y >= height:
                    continue
                if cost[y, x] > _UNMATCHED and cost[y, x] < np.inf:
                    continue
                trial[1] = planes[y, x, 1]
                trial[2] = planes[y, x, 2]
                trial[0] = planes[y, x, 0] - trial[1] * spread[i, 0] - trial[2] * spread[i, 1]
                if not faces_camera(trial, focal, least, most) or _alike(trial, kept, focal):
                    continue
                value = patch_cost(views, rule, u, v, trial, patch, deviation, costs)
                if value < lowest:
                    lowest = value
                    kept[:] = trial
            state = (seed * np.uint64(0x9E3779B97F4A7C15)) ^ (
                np.uint64(v * width + u + 1) * np.uint64(0xBF58476D1CE4E5B9)
            )
            state ^= state >> np.uint64(29)
            for change in range(0 if guess else 1, 4 if guess else 3):
                state = _change(change, kept, state, scale, least, most, focal, trial)
                if not faces_camera(trial, focal, least, most):
                    continue
                value = patch_cost(views, rule, u, v, trial, patch, deviation, costs)
                if value < lowest:
                    lowest = value
                    kept[:] = trial
            planes[v, u] = kept
            cost[v, u] = lowest


@njit(cache=True)
def refine_depth(grey, views, rule, planes, cost):
    """Move each plane to the vertex of the parabola through its cost half a pixel of disparity to either side."""
    height, width = grey.shape
    offsets, falloff, variance_floor, least_variance, _ = rule
    patch = (np.empty(offsets.shape[1], np.float32), np.empty(offsets.shape[1], np.float32))
    costs = np.empty(len(views[0]))
    trial = np.empty(3)
    beside = np.empty(2)
    for v in range(height):
        for u in range(width):
            if cost[v, u] > _UNMATCHED:
                continue
            deviation = weigh_patch(grey, u, v, offsets, falloff, variance_floor, least_variance, patch)
            trial[:] = planes[v, u]
            kept = trial[0]
            step = 0.5 / max(disparity_rate(views[1][0], views[2][0], u, v, kept), 1e-9)
            for side in range(2):
                trial[0] = kept + (2 * side - 1) * step
                beside[side] = patch_cost(views, rule, u, v, trial, patch, deviation, costs)
            curvature = beside[0] + beside[1] - 2 * cost[v, u]
            if curvature <= 0 or beside[0] < cost[v, u] or beside[1] < cost[v, u]:
                continue
            trial[0] = kept + step * 0.5 * (beside[0] - beside[1]) / curvature
            value = patch_cost(views, rule, u, v, trial, patch, deviation, costs)
            if value < cost[v, u]:
                cost[v, u] = value
                planes[v, u, 0] = trial[0]


@njit(cache=True)
def _change(change, kept, state, scale, least, most, focal, trial):
    """Put a changed plane into `trial`: at random (0), other depth (1), other slope (2), both (3); return the state."""
    state, first = _draw(state)
    state, second = _draw(state)
    state, third = _draw(state)
    trial[:] = kept
    if change == 0:
        trial[0] = least + (most - least) * 0.5 * (first + 1)
        trial[1] = second * trial[0] / focal
        trial[2] = third * trial[0] / focal
    if change == 1 or change == 3:
        trial[0] = kept[0] * (1 + 0.02 * scale * first)
    if change == 2 or change == 3:
        trial[1] += second * scale * kept[0] / focal
        trial[2] += third * scale * kept[0] / focal
    return state


@njit(cache=True)
def _draw(state):
    """Return the next state of the generator (xorshift) and a number in [-1, 1)."""
    state ^= state << np.uint64(13)
    state ^= state >> np.uint64(7)
    state ^= state << np.uint64(17)
    return state, np.float64(state >> np.uint64(11)) / 4503599627370496.0 - 1.0


@njit(cache=True)
def _alike(plane, other, focal):
    """Say whether two planes differ by less than refinement would."""
    apart = abs(plane[1] - other[1]) + abs(plane[2] - other[2])
    return abs(plane[0] - other[0]) < 5e-4 * other[0] and apart < 0.1 * other[0] / focal
