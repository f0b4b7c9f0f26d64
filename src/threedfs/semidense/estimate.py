"""Semi-dense inverse depth of one keyframe, as LSD-SLAM estimates it with known poses (Section 3.1)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from threedfs.geometry.projection import inside, project
from threedfs.semidense.epipolar import SearchRule
from threedfs.semidense.epipolar_segment import TEMPLATE_MARGIN
from threedfs.semidense.gradient import find_textured, image_gradient, to_grey
from threedfs.semidense.observe import observe_neighbour
from threedfs.semidense.pair import relate
from threedfs.semidense.prior import spread_sparse
from threedfs.semidense.regularise import regularise
from threedfs.types import Keyframe, View


class FusionRule(NamedTuple):
    """What makes an estimate; see `SemidenseParams` for each value."""

    min_gradient: float
    prior_radius: float
    prior_spread: float
    consistency: float
    min_support: int
    min_agreement: float
    smoothing: float
    min_neighbourhood: int


def order_by_baseline(keyframe: Keyframe) -> tuple[View, ...]:
    """Return the neighbours, nearest camera first: a short baseline has few false matches and narrows the rest."""
    centre = keyframe.view.centre
    return tuple(sorted(keyframe.neighbours, key=lambda view: (np.linalg.norm(view.centre - centre), view.name)))


def estimate_semidense(
    keyframe: Keyframe,
    image: np.ndarray,
    valid: np.ndarray,
    neighbours: Iterable[tuple[View, np.ndarray, np.ndarray]],
    sparse_points: np.ndarray,
    search: SearchRule,
    rule: FusionRule,
) -> tuple[np.ndarray, np.ndarray]:
    """Estimate inverse depth and its variance where the image has gradient and the neighbours agree.

    Differs from the paper: poses are given, so all neighbours observe the keyframe itself and nothing is propagated
    from frame to frame; estimates start from sparse points instead of at random; a minimum number of neighbours
    must agree.

    Parameters
    ----------
    keyframe : Keyframe
    image : (H, W, 3) uint8
    valid : (H, W) bool
        Pixels that show the scene.
    neighbours : iterable of (View, (H, W, 3) uint8, (H, W) bool)
        With their image, of any size, and its pixels that show the scene, in the order in which they are to observe;
        taken one at a time.
    sparse_points : (P, 3) float64
        Points that the keyframe sees, world.
    search : SearchRule
    rule : FusionRule

    Returns
    -------
    inverse_depth, variance : (H, W) float32
        1 / scene unit and its square; NaN where there is no estimate.
    """
    bounds = (1 / keyframe.far, 1 / keyframe.near)
    grey = to_grey(image)
    gradient_u, gradient_v = image_gradient(grey)
    searched = find_textured(grey, valid, rule.min_gradient, TEMPLATE_MARGIN)
    pixels, depth = project(keyframe.view, sparse_points)
    shown = inside(keyframe.view.camera, pixels)
    mean, variance = spread_sparse(
        pixels[shown],
        1 / depth[shown],
        grey.shape,
        bounds,
        rule.prior_radius * max(grey.shape),
        rule.prior_spread,
    )
    state = np.stack([mean, variance, np.zeros_like(mean), np.zeros_like(mean)])
    for view, other, other_valid in neighbours:
        observe_neighbour(
            grey,
            gradient_u,
            gradient_v,
            searched,
            to_grey(other),
            other_valid,
            relate(keyframe.view, view),
            search,
            bounds,
            rule.consistency,
            state,
        )
    mean, variance, agreed, contradicted = state
    support = min(rule.min_support, (len(keyframe.neighbours) + 1) // 2)
    believed = searched & (agreed >= support) & (agreed >= rule.min_agreement * (agreed + contradicted))
    inverse_depth, variance = regularise(
        np.where(believed, mean, np.nan),
        np.where(believed, variance, np.nan),
        rule.consistency,
        rule.smoothing,
        rule.min_neighbourhood,
    )
    return inverse_depth.astype(np.float32), variance.astype(np.float32)
