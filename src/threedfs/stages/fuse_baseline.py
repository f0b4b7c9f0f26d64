"""Fuse the object's depth maps by a method that ours is compared with."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from threedfs.fusion.fuse import fuse_views, limit_clip_distance
from threedfs.fusion.hard_maximum import HardMaximum
from threedfs.fusion.softmax import SoftMaximum
from threedfs.fusion.view_fusion import ViewFusion
from threedfs.fusion.weighted_average import WeightedAverage
from threedfs.geometry.grid import cover_box
from threedfs.io.keyframes import read_keyframes
from threedfs.io.volumes import Volume, read_support, write_volume
from threedfs.io.votes import read_votes
from threedfs.job import Job
from threedfs.params.fuse_baseline import FuseBaselineParams

_PRINTED_HARDNESS = 10.0
"""Of Eq. 15 (Section 3.3.1)."""

_FUSIONS: dict[str, Callable[..., ViewFusion]] = {
    "tsdf": WeightedAverage,
    "hard_maximum": HardMaximum,
    "soft_maximum": partial(SoftMaximum, hardness=_PRINTED_HARDNESS, distrust=0.0),
}


def run(
    *,
    keyframes: Path,
    depth: list[Path],
    support: Path,
    volume: Path,
    fusion: str,
    params: FuseBaselineParams,
    job: Job,
) -> None:
    """Lay the grid over the object's box, fuse, and write the volume; whether views agree does not matter."""
    place = read_support(support)
    grid = cover_box(place.box, params.longest_side)
    clip_distance = limit_clip_distance(
        params.clip_distance, place.figures["thickness"], params.thickness_share, grid.spacing
    )
    fused = _FUSIONS[fusion](grid, clip_distance, discontinuity=params.depth_discontinuity, threads=job.threads)
    votes = ((view, depth_map) for view, depth_map, *_ in read_votes(read_keyframes(keyframes), depth, None))
    sdf, seen = fuse_views(job.progress.track(votes, "keyframe", len(depth)), fused)
    write_volume(volume, Volume(grid, sdf, seen), job.header)
