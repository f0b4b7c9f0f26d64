"""The segment of an epipolar line on which a pixel may be seen (Engel, Sturm, Cremers 2013, Section 2.2)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

REACH = 2
"""Samples on either side of the pixel: 5 in all."""

_LEAST_RATE, _GREATEST_RATE = 0.4, 2.5
"""Pixels along the line in the neighbour per pixel in the keyframe, between which the images can be compared."""

TEMPLATE_MARGIN = math.ceil(REACH / _LEAST_RATE) + 1
"""Pixels of the keyframe around the searched one from which the samples may be interpolated."""

MAX_SPAN = 250.0
"""Greatest length of the searched segment, in pixels of the neighbour: five samples are not distinct on more."""

_MIN_SPAN = 6.0
"""Least length of the searched segment, in pixels of the neighbour."""


class EpipolarSegment(NamedTuple):
    """Where one pixel of the keyframe may be seen in a neighbour.

    Attributes
    ----------
    line_u, line_v : float
        Unit direction of the epipolar line in the keyframe.
    gradient : float
        Slope of the keyframe's grey levels, per pixel across its edge.
    cosine : float
        Of the angle between that gradient and the line.
    start_u, start_v : float
        First place in the neighbour.
    step_u, step_v : float
        Unit direction from place to place.
    places : int
        One a pixel of the neighbour.
    rate : float
        Pixels along the line in the neighbour per pixel in the keyframe.
    """

    line_u: float
    line_v: float
    gradient: float
    cosine: float
    start_u: float
    start_v: float
    step_u: float
    step_v: float
    places: int
    rate: float


_NO_SEGMENT = EpipolarSegment(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0.0)


@njit(cache=True)
def _distance(x0, y0, x1, y1):
    return math.sqrt((x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0))


@njit(cache=True)
def _transfer(infinite, baseline, u, v, inverse_depth):
    x = infinite[0, 0] * u + infinite[0, 1] * v + infinite[0, 2] + inverse_depth * baseline[0]
    y = infinite[1, 0] * u + infinite[1, 1] * v + infinite[1, 2] + inverse_depth * baseline[1]
    z = infinite[2, 0] * u + infinite[2, 1] * v + infinite[2, 2] + inverse_depth * baseline[2]
    return x, y, z


@njit(cache=True)
def invert_transfer(infinite, baseline, u, v, other_u, other_v, along_u):
    """Inverse depth at which (u, v) is seen at (other_u, other_v), from the coordinate that varies more."""
    x, y, z = _transfer(infinite, baseline, u, v, 0.0)
    if along_u:
        return (x - other_u * z) / (other_u * baseline[2] - baseline[0])
    return (y - other_v * z) / (other_v * baseline[2] - baseline[1])


@njit(cache=True)
def lay_segment(gradient_u, gradient_v, u, v, low, high, bounds, geometry, rule):
    """Lay the segment of a neighbour on which a pixel of the keyframe is searched.

    Parameters
    ----------
    gradient_u, gradient_v : (H, W) float32
        Gradient of the keyframe, grey levels a pixel.
    u, v : int
        Pixel.
    low, high : float
        Inverse depth at its ends, 1 / scene unit.
    bounds : tuple of float
        Least and greatest inverse depth there can be.
    geometry : PairGeometry
    rule : SearchRule

    Returns
    -------
    allowed : bool
        Whether the geometry allows a search.
    segment : EpipolarSegment
        Of no meaning unless it does.
    """
    infinite, baseline, epipole = geometry.infinite, geometry.baseline, geometry.epipole

    # The epipolar line through the pixel in the keyframe, and how steep the image is along it.
    line_u = epipole[0] - epipole[2] * u
    line_v = epipole[1] - epipole[2] * v
    length = math.sqrt(line_u * line_u + line_v * line_v)
    gradient = math.sqrt(gradient_u[v, u] * gradient_u[v, u] + gradient_v[v, u] * gradient_v[v, u])
    if length < 1e-12 or gradient < 1e-6:
        return False, _NO_SEGMENT
    line_u /= length
    line_v /= length
    cosine = (gradient_u[v, u] * line_u + gradient_v[v, u] * line_v) / gradient
    if cosine * cosine < rule.min_gradient_cosine2:
        return False, _NO_SEGMENT

    x0, y0, z0 = _transfer(infinite, baseline, u, v, low)
    x1, y1, z1 = _transfer(infinite, baseline, u, v, high)
    if z0 <= 0 or z1 <= 0:
        return False, _NO_SEGMENT
    x0, y0, x1, y1 = x0 / z0, y0 / z0, x1 / z1, y1 / z1
    span = _distance(x0, y0, x1, y1)
    wide0 = _transfer(infinite, baseline, u, v, bounds[0])
    wide1 = _transfer(infinite, baseline, u, v, bounds[1])
    if not 1e-9 < span <= MAX_SPAN or wide0[2] <= 0 or wide1[2] <= 0:
        return False, _NO_SEGMENT
    whole = _distance(wide0[0] / wide0[2], wide0[1] / wide0[2], wide1[0] / wide1[2], wide1[1] / wide1[2])
    if whole < 1:
        return False, _NO_SEGMENT
    step_u, step_v = (x1 - x0) / span, (y1 - y0) / span
    # A well-known depth leaves a short segment: the observation itself still needs room to differ.
    pad = max(0.0, (_MIN_SPAN - span) / 2)
    x0, y0, span = x0 - pad * step_u, y0 - pad * step_v, span + 2 * pad

    middle = 0.5 * (low + high)
    xa, ya, za = _transfer(infinite, baseline, u, v, middle)
    xb, yb, zb = _transfer(infinite, baseline, u + line_u, v + line_v, middle)
    rate = (xb / zb - xa / za) * step_u + (yb / zb - ya / za) * step_v
    if abs(rate) < _LEAST_RATE or abs(rate) > _GREATEST_RATE:
        return False, _NO_SEGMENT
    height, width = gradient_u.shape
    reach = REACH * abs(1 / rate)
    if u < reach + 1 or v < reach + 1 or u > width - 2 - reach or v > height - 2 - reach:
        return False, _NO_SEGMENT
    places = int(np.ceil(span)) + 1
    return True, EpipolarSegment(line_u, line_v, np.float64(gradient), cosine, x0, y0, step_u, step_v, places, rate)
