"""Fuse all depth maps again, on a fine grid around the object."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from threedfs.fusion.doubt import DoubtRule, Vote, doubt_mirrored, rate_shown
from threedfs.fusion.fuse import VoteRule, fuse_views, limit_clip_distance, start_fusion
from threedfs.geometry.grid import cover_box
from threedfs.io.consistency import ConsistencyStore, read_consistency
from threedfs.io.keyframes import read_keyframes
from threedfs.io.volumes import Volume, read_support, read_volume, write_volume
from threedfs.io.votes import read_votes
from threedfs.job import Job
from threedfs.locate.coarse import fill_notches, mark_coarse
from threedfs.params.fuse_object import FuseObjectParams
from threedfs.params.rules import make_rule
from threedfs.segment.outline import draw_voxels
from threedfs.types import Keyframe, Support


def run(
    *,
    keyframes: Path,
    depth: list[Path],
    consistency: Path,
    support: Path,
    scene: Path,
    volume: Path,
    params: FuseObjectParams,
    job: Job,
) -> None:
    """Lay the grid over the object's box, fuse, and write the volume.

    With `fuse_object.grid: region` the grid is that of the scene's volume, and `longest_side` says nothing. Mirror
    images of the support plane are told by the coarse object in that volume.
    """
    place, entries = read_support(support), read_keyframes(keyframes)
    grid = cover_box(place.box, params.longest_side) if params.grid == "object" else read_volume(scene).grid
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
    votes: Iterable[tuple] = read_votes(entries, depth, trust)
    if trust is not None and params.mirrored_height > 0:
        votes = _doubt_votes(entries, depth, trust, place, read_volume(scene), params, job)
    sdf, seen = fuse_views(job.progress.track(votes, "keyframe", len(depth)), fused)
    job.progress.note(f"grid {grid.shape}, voxel {grid.spacing:.4g}, clip distance {clip_distance / grid.spacing:.1f}")
    write_volume(volume, Volume(grid, sdf, seen), job.header)


def _doubt_votes(
    entries: Mapping[str, Keyframe],
    depth: list[Path],
    trust: ConsistencyStore,
    place: Support,
    coarse: Volume,
    params: FuseObjectParams,
    job: Job,
) -> Iterator[Vote]:
    """Return the votes of the keyframes; mirror images are doubted where the object's depth is unsure."""
    grid, solid = mark_coarse(coarse.grid, coarse.sdf, place)
    views = {name: entry.view for name, entry in entries.items()}
    shown = draw_voxels(solid, grid, views, job.threads)
    rule = make_rule(DoubtRule, params)
    sureness = rate_shown(read_votes(entries, depth, trust), shown, place, rule)
    votes = read_votes(entries, depth, trust)
    if sureness == 1:
        return votes
    job.progress.note(f"depth is unsure: mirror images of the support plane count {sureness:.2f}")
    grid, solid = fill_notches(grid, solid, place)
    return doubt_mirrored(votes, draw_voxels(solid, grid, views, job.threads), place, rule, sureness)
