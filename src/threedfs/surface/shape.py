"""From votes of depth and the hull of the masks to a closed surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from threedfs.hull.distance import measure_hull
from threedfs.hull.grid import may_be_hull
from threedfs.locate.height import height_above
from threedfs.object.extract import extract_surface
from threedfs.object.field import mask_field
from threedfs.object.smooth import smooth_mesh
from threedfs.surface.complete import HullRule, close_pits, complete_depth
from threedfs.surface.confirmed import ConfirmedDepth
from threedfs.surface.held import release_bound
from threedfs.surface.plate import bend_mesh, support_vertices
from threedfs.surface.sight import fill_unseen
from threedfs.surface.tunnels import close_hidden_tunnels, close_tunnels
from threedfs.types import Mesh, Plane, View


@dataclass(frozen=True)
class ShapeRule:
    """How the surface is shaped; `SurfaceParams` says more of each value."""

    complete: HullRule
    hull_tolerance: float
    bare_tolerance: float
    bound_tolerance: float
    held_share: float
    held_height: float
    gap_tolerance: float
    free_share: float
    closing: float
    tunnel_width: float
    hidden_tunnel_width: float
    medians: int
    smoothing_steps: int
    smoothing_contrast: float
    stiffness: float


def shape_surface(
    depth: ConfirmedDepth,
    plane: Plane,
    masks: Mapping[str, np.ndarray],
    views: Mapping[str, View],
    valid: Mapping[str, np.ndarray],
    rule: ShapeRule,
) -> Mesh | None:
    """Return the closed surface that agrees with depth and masks; None if nothing is inside.

    Not in the paper.

    Parameters
    ----------
    depth : ConfirmedDepth
        Stays as it is.
    plane : Plane
        The support plane.
    masks, views, valid : mapping of str
        (H, W) bool, View, and (H, W) bool: pixels that show the scene.
    rule : ShapeRule
    """
    if not any(masks[name].any() for name in views):
        return None
    grid, sureness = depth.fused.grid, depth.sureness
    height = height_above(plane, grid)
    # Only what is neither sure nor round has flat sides that the hull alone must hold.
    known = max(sureness, depth.roundness)
    tolerance = known * rule.hull_tolerance + (1 - known) * rule.bare_tolerance
    hull, bound, filler = measure_hull(
        masks,
        views,
        valid,
        grid,
        may_be_hull(height, grid),
        ramp=depth.clip_distance / grid.spacing,
        tolerances=(tolerance, rule.bound_tolerance, rule.gap_tolerance),
        threads=depth.threads,
    )
    bound = release_bound(bound, height, depth, masks, views, held_share=rule.held_share, held_height=rule.held_height)
    sdf = complete_depth(
        depth.fused,
        hull,
        bound,
        filler,
        sureness,
        depth.roundness,
        height > 0,
        masks,
        views,
        rule.complete,
        depth.threads,
    )
    sdf = close_pits(sdf, rule.closing * (1 - sureness))
    sdf = fill_unseen(sdf, filler, height > 0, plane.normal, depth, rule.free_share)
    alone = mask_field(sdf, np.ones(grid.shape, bool), height, grid.spacing, rule.medians)
    alone = close_tunnels(alone, height > 0, rule.tunnel_width, depth.threads)
    alone = close_hidden_tunnels(alone, height > 0, rule.hidden_tunnel_width, grid, plane.normal, depth.threads)
    if not (alone < 0).any():
        return None
    smooth = smooth_mesh(extract_surface(alone, grid), rule.smoothing_steps, rule.smoothing_contrast)
    if not rule.stiffness:
        return smooth
    return bend_mesh(smooth, support_vertices(smooth, depth, plane), rule.stiffness)
