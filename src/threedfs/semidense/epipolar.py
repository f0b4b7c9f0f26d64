"""Search along epipolar lines (Engel, Sturm, Cremers 2013, Section 2.2)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from threedfs.semidense.epipolar_segment import MAX_SPAN, REACH, invert_transfer, lay_segment

FOUND, NOT_SEARCHED, NOT_FOUND = 0, 1, 2
"""Outcomes: a distinct match; the geometry allows no search; there is no distinct match."""

WORK = math.ceil(MAX_SPAN) + 8
"""Scratch of one search: places along the longest segment, and what the window takes beyond its ends."""


class SearchRule(NamedTuple):
    """What counts as a match; see `SemidenseParams` for each value."""

    min_gradient_cosine2: float
    image_noise: float
    line_noise: float
    max_residual: float
    distinctness: float
    rival_margin: float


@njit(cache=True)
def _sample(image, u, v):
    column, row = int(u), int(v)
    a, b = u - column, v - row
    upper = (1 - a) * image[row, column] + a * image[row, column + 1]
    lower = (1 - a) * image[row + 1, column] + a * image[row + 1, column + 1]
    return (1 - b) * upper + b * lower


@njit(cache=True)
def _sample_line(image, u, v, step_u, step_v, samples):
    """Sample at equal steps from (u, v) on; NaN outside of the image and beside pixels that are NaN."""
    height, width = image.shape
    for k in range(len(samples)):
        at_u, at_v = u + k * step_u, v + k * step_v
        if 0 <= at_u < width - 1 and 0 <= at_v < height - 1:
            samples[k] = _sample(image, at_u, at_v)
        else:
            samples[k] = np.nan


@njit(cache=True)
def _compare(samples, template, differences):
    """Fill in for each place the squared difference to the template, whose mean is 0, less that of means.

    Returns
    -------
    seen, best : int
        Places at which all samples are known, and the first of those of least difference; -1 without any. The others'
        difference is infinite.
    """
    t0, t1, t2, t3, t4 = template
    of_template = t0 * t0 + t1 * t1 + t2 * t2 + t3 * t3 + t4 * t4
    seen, best = 0, -1
    least = np.inf
    for place in range(len(differences)):
        s0, s1, s2, s3, s4 = samples[place : place + 5]
        total = s0 + s1 + s2 + s3 + s4
        square = s0 * s0 + s1 * s1 + s2 * s2 + s3 * s3 + s4 * s4
        product = s0 * t0 + s1 * t1 + s2 * t2 + s3 * t3 + s4 * t4
        difference = max(square - 0.2 * total * total - 2 * product + of_template, 0.0)
        if total != total:
            difference = np.inf
        else:
            seen += 1
            if difference < least:
                least = difference
                best = place
        differences[place] = difference
    return seen, best


@njit(cache=True)
def _refine(differences, place):
    """Sub-step shift of a local minimum, and its value, by the parabola through its neighbours."""
    before, here, after = differences[place - 1], differences[place], differences[place + 1]
    bend = before - 2 * here + after
    if not 0 < bend < np.inf:
        return 0.0, here
    shift = 0.5 * (before - after) / bend
    return shift, max(here - 0.25 * (before - after) * shift, 0.0)


@njit(cache=True)
def _take_template(grey, u, v, segment):
    """Return the five samples of the keyframe around the pixel, less their mean, as far apart as the neighbour's."""
    step = 1 / segment.rate
    line_u, line_v = segment.line_u, segment.line_v
    t0 = _sample(grey, u - 2 * step * line_u, v - 2 * step * line_v)
    t1 = _sample(grey, u - step * line_u, v - step * line_v)
    t2 = np.float64(grey[v, u])
    t3 = _sample(grey, u + step * line_u, v + step * line_v)
    t4 = _sample(grey, u + 2 * step * line_u, v + 2 * step * line_v)
    mean = 0.2 * (t0 + t1 + t2 + t3 + t4)
    return t0 - mean, t1 - mean, t2 - mean, t3 - mean, t4 - mean


@njit(cache=True)
def _find_distinct(differences, best, rule):
    """Return the sub-step shift of the best place, or NaN if it is an end, differs much or has a rival."""
    last = len(differences) - 1
    if best == 0 or best == last or differences[best - 1] == np.inf or differences[best + 1] == np.inf:
        return np.nan
    shift, least = _refine(differences, best)
    if least > (2 * REACH + 1) * rule.max_residual**2:
        return np.nan
    # Noise alone leaves this much difference at the true place, so a rival must stand out from it too.
    noise = 2 * (2 * REACH) * rule.image_noise**2
    for place in range(len(differences)):
        if abs(place - best) > 1:
            rival = differences[place]
            if 0 < place < last and rival <= differences[place - 1] and rival <= differences[place + 1]:
                rival = _refine(differences, place)[1]
            if rival < rule.distinctness * least + rule.rival_margin * noise:
                return np.nan
    return shift


@njit(cache=True)
def search_line(grey, gradient_u, gradient_v, other, u, v, low, high, bounds, geometry, rule, work):
    """Search the inverse depth of one pixel between `low` and `high`.

    Five samples along the epipolar line are compared by the sum of squared differences, less that of their
    means: exposure may drift between views. The best place must lie inside the segment, differ little, and be
    better than every place over one step away by the factor `distinctness`; a parabola gives the sub-pixel step.

    Parameters
    ----------
    grey, gradient_u, gradient_v : (H, W) float32
        Keyframe, and its gradient.
    other : (H2, W2) float32
        Neighbour; NaN where it shows nothing.
    u, v : int
        Pixel.
    low, high : float
        Segment to search, inverse depth.
    bounds : tuple of float
        Least and greatest inverse depth there can be.
    geometry : PairGeometry
    rule : SearchRule
    work : (2, WORK) float64
        Scratch.

    Returns
    -------
    outcome : int
        FOUND, NOT_SEARCHED or NOT_FOUND.
    inverse_depth, variance : float
        Variance = alpha^2 (1 / 400 + sigma_geometry^2 + sigma_photometry^2), alpha the change of inverse
        depth per pixel along the line; NaN unless FOUND.
    """
    allowed, segment = lay_segment(gradient_u, gradient_v, u, v, low, high, bounds, geometry, rule)
    if not allowed:
        return NOT_SEARCHED, np.nan, np.nan
    step_u, step_v, places = segment.step_u, segment.step_v, segment.places

    # Samples run two steps past either end for the window and one more for the parabola.
    samples = work[0, : places + 2 * (REACH + 1)]
    outset = REACH + 1
    _sample_line(other, segment.start_u - outset * step_u, segment.start_v - outset * step_v, step_u, step_v, samples)
    differences = work[1, : places + 2]
    seen, best = _compare(samples, _take_template(grey, u, v, segment), differences)
    if seen < 3:
        return NOT_SEARCHED, np.nan, np.nan
    shift = _find_distinct(differences, best, rule)
    if np.isnan(shift):
        return NOT_FOUND, np.nan, np.nan

    position = best - 1 + shift
    found_u, found_v = segment.start_u + position * step_u, segment.start_v + position * step_v
    along_u = abs(step_u) > abs(step_v)
    infinite, baseline = geometry.infinite, geometry.baseline
    inverse_depth = invert_transfer(infinite, baseline, u, v, found_u, found_v, along_u)
    if not bounds[0] <= inverse_depth <= bounds[1]:
        return NOT_FOUND, np.nan, np.nan
    beyond = invert_transfer(infinite, baseline, u, v, found_u + step_u, found_v + step_v, along_u)
    alpha = beyond - inverse_depth
    cosine = segment.cosine
    slope = (samples[best + REACH + 1] - samples[best + REACH - 1]) / 2
    slope = max(abs(slope), 0.5 * abs(segment.gradient * cosine / segment.rate))
    variance = alpha**2 * (1 / 400 + rule.line_noise**2 / (cosine * cosine) + 2 * rule.image_noise**2 / slope**2)
    return FOUND, inverse_depth, variance
