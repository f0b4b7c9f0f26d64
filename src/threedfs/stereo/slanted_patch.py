"""Numba kernels of patch-match stereo: the photometric cost of slanted patches, and their propagation.

A patch of the reference is a plane, held as the inverse depth at its pixel and the slopes of inverse depth along
columns and rows: on a plane inverse depth is affine in the pixel. A neighbour sees pixel x of the plane at
through_infinity x + epipole inverse_depth(x), homogeneous. Over the width of a patch that map is taken as affine.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from threedfs.depth.zncc import MISSING

_MISSING_SUM = float(MISSING) / 1e4
_STEEPEST = 4.0  # largest slope of a patch against the image plane: the tangent of about 76 degrees
_BORDER = 0.01  # pixels; rounding moves no sample beyond the image
_MOST_STRETCH = 6.0  # by how much a patch's area may shrink or grow from view to view


@njit(cache=True)
def weigh_patch(reference, u, v, offsets, falloff, variance_floor, least_variance, patch):
    """Weigh the samples of a patch by their likeness to its centre; fill `patch`: weights, and values less their mean.

    Returns
    -------
    float
        1 / sqrt(weighted variance + floor); 0 where the patch leaves the valid image or has no texture.
    """
    height, width = reference.shape
    weights, values = patch
    centre = reference[v, u]
    total = 0.0
    mean = 0.0
    for i in range(offsets.shape[1]):
        x = u + offsets[0, i]
        y = v + offsets[1, i]
        if x < 0 or y < 0 or x >= width or y >= height:
            return 0.0
        value = reference[y, x]
        if value < _MISSING_SUM:
            return 0.0
        weight = np.exp(-np.abs(value - centre) * falloff)
        weights[i] = weight
        values[i] = value
        total += weight
        mean += weight * value
    mean /= total
    variance = 0.0
    for i in range(offsets.shape[1]):
        weights[i] /= total
        values[i] -= mean
        variance += weights[i] * values[i] * values[i]
    return 1 / np.sqrt(variance + variance_floor) if variance >= least_variance else 0.0


@njit(cache=True, error_model="numpy")
def view_cost(image, infinity, epipole, u, v, plane, offsets, patch, inverse_deviation, variance_floor):
    """Compare a weighed patch with one neighbour: (1 - NCC) / 2 in [0, 1], or -1 where it is not seen there.

    Parameters
    ----------
    image : (H, W) float32
    infinity, epipole : (3, 3) and (3,) float64
    u, v : int, pixel of the reference
    plane : (3,) float64
        Inverse depth at the pixel, and its change along columns and rows.
    offsets : (2, S) int32
    patch : (weights, values), each (S,) float32
    inverse_deviation, variance_floor : float
        As `weigh_patch` returns and takes them.

    Notes
    -----
    Almost all the time of stereo is spent here. So that the samples compile to vector instructions, they are float32,
    the image is read as one row, and their sums may be taken in any order (the order depends on the processor).
    """
    height, width = image.shape
    weights, values = patch
    w, gu, gv = plane[0], plane[1], plane[2]
    x0 = infinity[0, 0] * u + infinity[0, 1] * v + infinity[0, 2] + epipole[0] * w
    x1 = infinity[1, 0] * u + infinity[1, 1] * v + infinity[1, 2] + epipole[1] * w
    x2 = infinity[2, 0] * u + infinity[2, 1] * v + infinity[2, 2] + epipole[2] * w
    if x2 <= 1e-6:
        return -1.0
    x = x0 / x2
    y = x1 / x2
    d2u = infinity[2, 0] + epipole[2] * gu
    d2v = infinity[2, 1] + epipole[2] * gv
    xu = (infinity[0, 0] + epipole[0] * gu - x * d2u) / x2
    xv = (infinity[0, 1] + epipole[0] * gv - x * d2v) / x2
    yu = (infinity[1, 0] + epipole[1] * gu - y * d2u) / x2
    yv = (infinity[1, 1] + epipole[1] * gv - y * d2v) / x2
    stretch = xu * yv - xv * yu
    if stretch < 1 / _MOST_STRETCH or stretch > _MOST_STRETCH:
        return -1.0
    reach = -offsets[0, 0]
    across = reach * (abs(xu) + abs(xv)) + _BORDER
    down = reach * (abs(yu) + abs(yv)) + _BORDER
    if x - across < 0 or y - down < 0 or x + across >= width - 1 or y + down >= height - 1:
        return -1.0
    pixels = image.ravel()
    line = np.int32(width)
    x, y = np.float32(x), np.float32(y)
    xu, xv, yu, yv = np.float32(xu), np.float32(xv), np.float32(yu), np.float32(yv)
    mean = np.float32(0)
    square = np.float32(0)
    product = np.float32(0)
    for i in range(offsets.shape[1]):
        du = np.float32(offsets[0, i])
        dv = np.float32(offsets[1, i])
        sx = x + xu * du + xv * dv
        sy = y + yu * du + yv * dv
        column = np.int32(sx)
        row = np.int32(sy)
        fx = sx - np.float32(column)
        fy = sy - np.float32(row)
        place = np.uint32(row * line + column)
        below = place + np.uint32(line)
        upper = pixels[place] + fx * (pixels[place + np.uint32(1)] - pixels[place])
        lower = pixels[below] + fx * (pixels[below + np.uint32(1)] - pixels[below])
        sample = upper + fy * (lower - upper)
        weighed = weights[i] * sample
        mean += weighed
        square += weighed * sample
        product += weighed * values[i]
    if mean < _MISSING_SUM:
        return -1.0
    variance = max(square - mean * mean, np.float32(0)) + variance_floor
    correlation = product * inverse_deviation / np.sqrt(variance)
    return 0.5 * (1.0 - min(max(correlation, -1.0), 1.0))


@njit(cache=True)
def patch_cost(views, rule, u, v, plane, patch, inverse_deviation, costs):
    """Average the cost of a patch over the views that match it best; 1 where fewer see it."""
    images, infinity, epipole = views
    offsets, _, variance_floor, _, best = rule
    seen = 0
    for view in range(len(images)):
        cost = view_cost(
            images[view], infinity[view], epipole[view], u, v, plane, offsets, patch, inverse_deviation, variance_floor
        )
        if cost >= 0:
            place = seen
            while place > 0 and costs[place - 1] > cost:
                costs[place] = costs[place - 1]
                place -= 1
            costs[place] = cost
            seen += 1
    if seen < best:
        return 1.0
    total = 0.0
    for i in range(best):
        total += costs[i]
    return total / best


@njit(cache=True)
def faces_camera(plane, focal, least, most):
    """Say whether a plane's inverse depth lies between two, and the plane is not too steep."""
    limit = _STEEPEST * plane[0] / focal
    return least <= plane[0] <= most and plane[1] * plane[1] + plane[2] * plane[2] <= limit * limit


@njit(cache=True)
def disparity_rate(infinity, epipole, u, v, inverse_depth):
    """Return by how many pixels a neighbour's image of a pixel moves per unit of inverse depth; 0 behind it."""
    x0 = infinity[0, 0] * u + infinity[0, 1] * v + infinity[0, 2] + epipole[0] * inverse_depth
    x1 = infinity[1, 0] * u + infinity[1, 1] * v + infinity[1, 2] + epipole[1] * inverse_depth
    x2 = infinity[2, 0] * u + infinity[2, 1] * v + infinity[2, 2] + epipole[2] * inverse_depth
    if x2 <= 1e-6:
        return 0.0
    return np.hypot(epipole[0] - epipole[2] * x0 / x2, epipole[1] - epipole[2] * x1 / x2) / x2
