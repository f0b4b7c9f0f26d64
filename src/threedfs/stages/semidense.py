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
from threedfs.params.semidense import SemidenseParams
from threedfs.semidense.estimate import FusionRule, estimate_semidense, order_by_baseline
from threedfs.semidense.observe import SearchRule


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
        search=SearchRule(
            min_gradient_cosine2=params.min_gradient_cosine2,
            image_noise=params.image_noise,
            line_noise=params.line_noise,
            max_residual=params.max_residual,
            distinctness=params.distinctness,
            rival_margin=params.rival_margin,
        ),
        rule=FusionRule(
            min_gradient=params.min_gradient,
            prior_radius=params.prior_radius,
            prior_spread=params.prior_spread,
            consistency=params.consistency,
            min_support=params.min_support,
            min_agreement=params.min_agreement,
            smoothing=params.smoothing,
            min_neighbourhood=params.min_neighbourhood,
        ),
    )
    write_semidense(semidense, Semidense(inverse_depth, variance), job.header)
    job.progress.note(f"{keyframe}: {int(np.isfinite(inverse_depth).sum())} semi-dense points")
