"""Estimate the semi-dense depth of one keyframe."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.io.crops import read_crops
from threedfs.io.depth_maps import Semidense, write_semidense
from threedfs.io.keyframes import read_keyframe
from threedfs.io.points import read_points
from threedfs.io.poses import read_poses
from threedfs.job import Job
from threedfs.params.rules import make_rule
from threedfs.params.semidense import SemidenseParams
from threedfs.semidense.epipolar import SearchRule
from threedfs.semidense.estimate import FusionRule, estimate_semidense, order_by_baseline


def run(
    *,
    crops: Path,
    keyframes: Path,
    poses: Path,
    points: Path,
    semidense: Path,
    keyframe: str,
    params: SemidenseParams,
    job: Job,
) -> None:
    """Read one keyframe, its images and sparse points; write its semi-dense map."""
    store = read_crops(crops)
    chosen = read_keyframe(keyframes, keyframe)
    sparse = read_points(points)
    frame = [view.name for view in read_poses(poses).views].index(keyframe)
    inverse_depth, variance = estimate_semidense(
        keyframe=chosen,
        image=store.image(keyframe),
        valid=store.valid_of(keyframe),
        neighbours=((view, store.image(view.name), store.valid_of(view.name)) for view in order_by_baseline(chosen)),
        sparse_points=sparse.xyz[sparse.seen_by(frame)],
        search=make_rule(SearchRule, params),
        rule=make_rule(FusionRule, params),
    )
    write_semidense(semidense, Semidense(inverse_depth, variance), job.header)
    job.progress.note(f"{keyframe}: {int(np.isfinite(inverse_depth).sum())} semi-dense points")
