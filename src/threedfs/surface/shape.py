"""From votes of depth and the hull of the masks to a closed surface."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass

import numpy as np

from threedfs.fusion.softmax import SoftMaximum
from threedfs.hull.distance import measure_hull
from threedfs.hull.grid import may_be_hull
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field
from threedfs.object.smooth import smooth_mesh
from threedfs.surface.complete import HullRule, close_pits, complete_depth
from threedfs.types import Mesh, View


@dataclass(frozen=True)
class ShapeRule:
    """How the surface is shaped; `SurfaceParams` says more of each value."""

    complete: HullRule
    hull_tolerance: float
    bound_tolerance: float
    gap_tolerance: float
    closing: float
    medians: int
    smoothing_steps: int
    smoothing_contrast: float


def shape_surface(
    fused: SoftMaximum,
    clip_distance: float,
    sureness: float,
    height: np.ndarray,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    rule: ShapeRule,
) -> Mesh | None:
    """Return the closed surface that agrees with the depth fused so far and with masks; None if nothing is inside.

    Not in the paper.

    Parameters
    ----------
    fused : SoftMaximum
        Holds the votes of all views' depth; stays as it is.
    clip_distance : float
        Of those votes, scene units.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    height : (nx, ny, nz) float32
        Above the support plane, scene units.
    masks, views, valid : mapping of str
        (H, W) bool, View, and (H, W) bool: pixels that show the scene.
    rule : ShapeRule
    """
    if not any(masks[name].any() for name in views):
        return None
    grid = fused.grid
    hulls = measure_hull(
        masks,
        views,
        valid,
        grid,
        may_be_hull(height, grid),
        ramp=clip_distance / grid.spacing,
        tolerances=(rule.hull_tolerance, rule.bound_tolerance, rule.gap_tolerance),
    )
    sdf = complete_depth(deepcopy(fused), *hulls, sureness, height > 0, masks, views, rule.complete)
    sdf = close_pits(sdf, rule.closing * (1 - sureness))
    alone = mask_field(sdf, np.ones(grid.shape, bool), height, grid.spacing, rule.medians)
    if not (alone < 0).any():
        return None
    return smooth_mesh(extract_surface(alone, grid), rule.smoothing_steps, rule.smoothing_contrast)
