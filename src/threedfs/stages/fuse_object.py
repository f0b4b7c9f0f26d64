"""Fuse all depth maps again, on a fine grid around the object."""

from __future__ import annotations

from pathlib import Path

from threedfs.fusion.fuse import VoteRule, fuse_views, limit_clip_distance, start_fusion
from threedfs.geometry.grid import cover_box
from threedfs.io.consistency import read_consistency
from threedfs.io.keyframes import read_keyframes
from threedfs.io.volumes import Volume, read_support, read_volume, write_volume
from threedfs.io.votes import read_votes
from threedfs.job import Job
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule


def run(
    *,
    keyframes: Path,
    depth: list[Path],
    consistency: Path,
    support: Path,
    scene: Path | None,
    volume: Path,
    params: FuseObjectParams,
    job: Job,
) -> None:
    """Lay the grid over the object's box, fuse, and write the volume.

    With `fuse_object.grid: region` the grid is that of the scene's volume, and `longest_side` says nothing.
    """
    place = read_support(support)
    grid = cover_box(place.box, params.longest_side) if scene is None else read_volume(scene).grid
    clip_distance = limit_clip_distance(
        params.clip_distance, place.figures["thickness"], params.thickness_share, grid.spacing
    )
    fused = start_fusion(
        grid,
        clip_distance,
        make_rule(VoteRule, params),
        hidden_distance=params.hidden_distance * grid.spacing,
        threads=job.threads,
    )
    trust = read_consistency(consistency) if params.weighting == "consistency" else None
    votes = read_votes(read_keyframes(keyframes), depth, trust)
    sdf, seen = fuse_views(job.progress.track(votes, "keyframe", len(depth)), fused)
    job.progress.note(f"grid {grid.shape}, voxel {grid.spacing:.4g}, clip distance {clip_distance / grid.spacing:.1f}")
    write_volume(volume, Volume(grid, sdf, seen), job.header)
