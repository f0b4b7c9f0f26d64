"""Check the depth maps of all keyframes against each other."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.fusion.consistency import ComparisonRule, check_consistency, rate_confidence
from threedfs.io.consistency import ConsistencyMap, write_consistency
from threedfs.io.depth_maps import read_depth_map
from threedfs.io.keyframes import read_keyframes
from threedfs.job import Job
from threedfs.params.consistency import ConsistencyParams
from threedfs.params.rules import make_rule

_KEPT = 100
"""Depth maps in memory, each of which is read for many others: 100 MB of crops, 370 MB of whole frames."""


def run(
    *,
    keyframes: Path,
    depth: list[Path],
    consistency: Path,
    params: ConsistencyParams,
    job: Job,
) -> None:
    """Read all depth maps; write how far each pixel of each agrees with the others.

    Raises
    ------
    UserError
        If a keyframe has no depth map.
    """
    views = [entry.view for entry in read_keyframes(keyframes).values()]
    paths = {path.name.removesuffix(".zarr.zip"): path for path in depth}
    missing = [view.name for view in views if view.name not in paths]
    if missing:
        raise UserError(
            f"{keyframes}: expected a depth map for each of its {len(views)} keyframes, found none for "
            f"{', '.join(missing)}; run again, rule depth writes them."
        )

    @lru_cache(_KEPT)
    def read_depth(rank: int) -> np.ndarray:
        return read_depth_map(paths[views[rank].name]).depth

    agreements = check_consistency(
        views,
        read_depth,
        make_rule(ComparisonRule, params, tolerance=params.depth_tolerance),
        job.threads,
    )

    def rate() -> Iterator[tuple[str, ConsistencyMap]]:
        for view, agreement in zip(views, job.progress.track(agreements, "keyframe", len(views)), strict=True):
            photometric = read_depth_map(paths[view.name]).confidence
            confidence = rate_confidence(
                agreement, photometric, prior_views=params.prior_views, full_share=params.full_share
            )
            yield view.name, ConsistencyMap(confidence, **vars(agreement))

    write_consistency(consistency, rate(), job.header)
