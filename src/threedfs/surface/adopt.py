"""Depth that a keyframe adopts from others where its own photographs do not match."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numba import njit

from threedfs.blur import blur
from threedfs.geometry.transfer import px_from_px, transfer
from threedfs.ramp import rise
from threedfs.surface.keyframe_depth import KeyframeDepth
from threedfs.types import View

_LEAST_COSINE = 0.3
"""Between normal and ray: what is turned away is the back of something thin, or seen too flatly to count pixels of."""
_LEAST_CONFIDENCE = 0.5
"""Share of agreement below which depth is not lent, however many agree."""
_ENOUGH = 1.0
"""Points around a pixel, on the mean over pixels, from which what they say is adopted fully."""


@dataclass(frozen=True)
class AdoptRule:
    """When depth is lent and adopted; `SurfaceParams` says more of each value."""

    lent_from: float
    adopted_within: float
    adopted_reach: float
    adopted_full: float
    adopted_until: float


@dataclass(frozen=True)
class LentDepth:
    """A depth map that others may adopt.

    Attributes
    ----------
    view : View
    depth : (H, W) float32
        Scene units, NaN where missing.
    lends : (H, W) bool
        Where others may.
    """

    view: View
    depth: np.ndarray
    lends: np.ndarray


def lend_depth(found: KeyframeDepth, rule: AdoptRule) -> LentDepth:
    """Return what a keyframe's depth of the object may lend to others: what many views agree on.

    Not in the paper.
    """
    agreed = (found.agree >= rule.lent_from) & (found.confidence >= _LEAST_CONFIDENCE)
    return LentDepth(found.view, found.depth, found.mask & agreed)


def adopt_depth(found: KeyframeDepth, matched: np.ndarray, lent: Iterable[LentDepth], rule: AdoptRule) -> np.ndarray:
    """Return a depth map (H, W) float32, moved to what other views have found where few of its own photographs match.

    Not in the paper. Nothing but smoothness holds depth where no photograph matches, so that it swings to one side or
    the other, by more than views may differ and agree. What others have found and many agree on is drawn into the view,
    point by point, where it is turned to it and near to the view's own depth, and the mean over some pixels around is
    adopted, on the object alone. How far the pixel is trusted is not: all who adopt the same error would agree on it.

    Parameters
    ----------
    found : KeyframeDepth
    matched : (H, W) float32
        Share of matches around (`share_matched`).
    lent : iterable of LentDepth
        Of the other views.
    rule : AdoptRule
    """
    depth = found.depth
    bare = np.where(found.mask, 1 - rise(matched, rule.adopted_full, rule.adopted_until), 0.0)
    if not bare.any():
        return depth
    points = np.zeros((2, *depth.shape))  # their number, and the sum of their relative offsets
    for other in lent:
        _draw(
            px_from_px(found.view, other.view),
            np.linalg.inv(other.view.camera.px_from_cam),
            other.view.cam_from_world[:3] @ np.append(found.view.centre, 1.0),
            other.depth,
            other.lends,
            depth,
            bare,
            rule.adopted_within,
            points,
        )
    reach = rule.adopted_reach * found.length
    number, offset = (blur(item, reach) for item in points)
    open_to_it = blur((bare > 0).astype(np.float64), reach)
    share = bare * np.minimum(1, number / np.maximum(_ENOUGH * open_to_it, 1e-3))
    return (depth * (1 + share * offset / np.maximum(number, 1e-6))).astype(np.float32)


@njit(cache=True, nogil=True)
def _draw(matrix, cam_from_px, centre, depth, lends, own_depth, bare, within, points):
    rows, columns = depth.shape
    for row in range(1, rows - 1):
        for column in range(1, columns - 1):
            if not lends[row, column]:
                continue
            u, v, z = transfer(matrix, column, row, depth[row, column])
            if not (u > -0.5 and v > -0.5 and u < bare.shape[1] - 0.5 and v < bare.shape[0] - 0.5):
                continue
            own_row, own_column = int(v + 0.5), int(u + 0.5)
            offset = z / own_depth[own_row, own_column] - 1
            if not (bare[own_row, own_column] > 0 and abs(offset) < within):
                continue
            if _cosine_to(cam_from_px, centre, depth, row, column) > _LEAST_COSINE:
                points[0, own_row, own_column] += 1
                points[1, own_row, own_column] += offset


@njit(cache=True, nogil=True)
def _cosine_to(cam_from_px, centre, depth, row, column):
    """Return the cosine between a depth map's normal, which faces its own camera, and the ray to another's centre.

    As `normals_from_depth` has it, but of the few points that are drawn: maps for all views would fill the memory.
    """
    left, right = _point(cam_from_px, depth, row, column - 1), _point(cam_from_px, depth, row, column + 1)
    above, below = _point(cam_from_px, depth, row - 1, column), _point(cam_from_px, depth, row + 1, column)
    here = _point(cam_from_px, depth, row, column)
    across = right[0] - left[0], right[1] - left[1], right[2] - left[2]
    down = below[0] - above[0], below[1] - above[1], below[2] - above[2]
    normal = (
        across[1] * down[2] - across[2] * down[1],
        across[2] * down[0] - across[0] * down[2],
        across[0] * down[1] - across[1] * down[0],
    )
    ray = centre[0] - here[0], centre[1] - here[1], centre[2] - here[2]
    cosine = _product(normal, ray) / np.sqrt(_product(normal, normal) * _product(ray, ray))
    return -cosine if _product(normal, here) > 0 else cosine


@njit(cache=True, nogil=True)
def _point(cam_from_px, depth, row, column):
    x = cam_from_px[0, 0] * column + cam_from_px[0, 1] * row + cam_from_px[0, 2]
    y = cam_from_px[1, 0] * column + cam_from_px[1, 1] * row + cam_from_px[1, 2]
    d = np.float64(depth[row, column])
    return d * x, d * y, d


@njit(cache=True, nogil=True)
def _product(one, other):
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
