"""Fuse all depth maps on the grid of the scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.fusion.fuse import VoteRule, fuse_views, start_fusion
from threedfs.geometry.grid import cover_box
from threedfs.io.consistency import read_consistency
from threedfs.io.keyframes import read_keyframes
from threedfs.io.points import read_points
from threedfs.io.volumes import Volume, write_volume
from threedfs.io.votes import read_votes
from threedfs.job import Job
from threedfs.locate.fixation import find_fixation, viewing_distance
from threedfs.locate.region import scene_region
from threedfs.params.fuse_scene import FuseSceneParams
from threedfs.params.rules import make_rule


def run(
    *,
    keyframes: Path,
    points: Path,
    depth: list[Path],
    consistency: Path,
    scene: Path,
    params: FuseSceneParams,
    job: Job,
) -> None:
    """Lay the grid over the region of interest of the sparse points, fuse, and write the volume."""
    entries = read_keyframes(keyframes)
    views = [entry.view for entry in entries.values()]
    xyz = read_points(points).xyz
    fixation = find_fixation(views, np.median(xyz, axis=0))
    distance = viewing_distance(views, fixation)
    region = scene_region(
        xyz,
        params.region_deviations,
        fixation,
        params.region_least_reach * distance,
        params.region_reach * distance,
    )
    grid = cover_box(region, params.longest_side)
    fused = start_fusion(
        grid,
        params.clip_distance * grid.spacing,
        make_rule(VoteRule, params),
        threads=job.threads,
    )
    trust = read_consistency(consistency) if params.weighting == "consistency" else None
    votes = read_votes(entries, depth, trust)
    sdf, seen = fuse_views(job.progress.track(votes, "keyframe", len(depth)), fused)
    write_volume(scene, Volume(grid, sdf, seen), job.header)
