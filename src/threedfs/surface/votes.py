"""Votes of depth on the surface's grid, before any has been cast."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.fusion.fuse import VoteRule, limit_clip_distance, start_fusion
from threedfs.fusion.softmax import SoftMaximum
from threedfs.types import VoxelGrid


@dataclass(frozen=True)
class ReachRule:
    """How far the votes of a depth reach; `FuseObjectParams` and `SurfaceParams` say more of each value."""

    clip_distance: float
    hidden_distance: float
    thickness_share: float
    sure_clip_share: float


def start_votes(
    grid: VoxelGrid,
    sureness: float,
    thickness: float,
    voxel: float,
    reach: ReachRule,
    rule: VoteRule,
    threads: int = 1,
) -> tuple[SoftMaximum, float]:
    """Return votes to add to, and their clip distance in scene units.

    Not in the paper. Votes of a sure depth reach less far, so that fine parts stay apart.

    Parameters
    ----------
    grid : VoxelGrid
        Of the surface.
    sureness : float
        Of the object's depth, in [0, 1] (`rate_sureness`).
    thickness : float
        Of the object, scene units.
    voxel : float
        Edge of a voxel of the object's grid, in which the rule counts, scene units.
    reach : ReachRule
    rule : VoteRule
    threads : int
        Cores used; no result depends on it.
    """
    share = 1 - sureness * (1 - reach.sure_clip_share)
    widest = max(2.0, share * reach.clip_distance)
    clip_distance = limit_clip_distance(widest, thickness, share * reach.thickness_share, voxel)
    hidden_distance = share * reach.hidden_distance * voxel
    return start_fusion(grid, clip_distance, rule, hidden_distance=hidden_distance, threads=threads), clip_distance
