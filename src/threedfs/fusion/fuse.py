"""Fusing posed depth maps on a grid, one at a time."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from threedfs.errors import UserError
from threedfs.fusion.softmax import SoftMaximum
from threedfs.fusion.view_fusion import ViewFusion
from threedfs.types import VoxelGrid


@dataclass(frozen=True)
class VoteRule:
    """How views vote in the soft maximum; `SoftMaximum` and `FusionSettings` say more of each value."""

    softmax_hardness: float
    distrust: float
    hidden: float
    depth_discontinuity: float
    facing: float
    trust_blur: float


def start_fusion(
    grid: VoxelGrid, clip_distance: float, rule: VoteRule, *, hidden_distance: float = math.inf, threads: int = 1
) -> SoftMaximum:
    """Return a soft maximum without votes; distances in scene units, as `SoftMaximum` takes them."""
    return SoftMaximum(
        grid,
        clip_distance,
        rule.softmax_hardness,
        distrust=rule.distrust,
        hidden=rule.hidden,
        hidden_distance=hidden_distance,
        discontinuity=rule.depth_discontinuity,
        facing=rule.facing,
        trust_blur=rule.trust_blur,
        threads=threads,
    )


def fuse_views(votes: Iterable[tuple], fused: ViewFusion) -> tuple[np.ndarray, np.ndarray]:
    """Fuse the depth maps of all views (3.3.1); never more than a few are held.

    Parameters
    ----------
    votes : iterable of tuple
        Of each view what the fusion's `weigh` takes: the view, its depth map, and more for the soft maximum.
    fused : ViewFusion

    Returns
    -------
    sdf : (nx, ny, nz) float32
    seen : (nx, ny, nz) uint8

    Raises
    ------
    UserError
        If no view sees any voxel.
    """
    fused.add_all(votes)
    sdf, seen = fused.result()
    if not seen.any():
        raise UserError(
            "No keyframe with depth sees the region to be fused; expected the cameras to look at the sparse points; "
            "check that the poses belong to these frames."
        )
    return sdf, seen


def limit_clip_distance(clip_distance: float, thickness: float, share: float, spacing: float) -> float:
    """Return the clip distance in scene units, at most `share` of the object's thickness but at least 2 voxels.

    Differs from the paper: its clip distance is a constant (Eq. 14), with which the field of an object thinner than
    twice that never reaches -1 inside; with `share` 0 it is the paper's.

    Parameters
    ----------
    clip_distance : float
        In voxels, at least 2.
    thickness : float
        Of the object, scene units.
    share : float
        0 for no limit.
    spacing : float
        Edge of a voxel, scene units.
    """
    if share == 0:
        return clip_distance * spacing
    return float(np.clip(share * thickness, 2 * spacing, clip_distance * spacing))
