"""Keep those stereo matches of one keyframe that other keyframes confirm."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.fusion.consistency import count_agreeing
from threedfs.io.depth_maps import StereoMap, read_stereo, write_stereo
from threedfs.io.keyframes import read_keyframes
from threedfs.job import Job
from threedfs.params.stereo_check import StereoCheckParams
from threedfs.stereo.confirm import confirm_matches


def run(
    *,
    keyframes: Path,
    stereo: list[Path],
    checked: Path,
    keyframe: str,
    params: StereoCheckParams,
    job: Job,
) -> None:
    """Read the patches of all keyframes that look the same way; write the keyframe's own without those in doubt."""
    paths = {path.name.removesuffix(".zarr.zip"): path for path in stereo}
    views = [entry.view for entry in read_keyframes(keyframes).values()]

    def read_depth(rank: int) -> np.ndarray:
        item = read_stereo(paths[views[rank].name])
        return np.where(item.cost <= params.max_cost, 1 / item.inverse_depth, np.nan)

    rank = [view.name for view in views].index(keyframe)
    agreeing = count_agreeing(views, read_depth, rank, tolerance=params.depth_tolerance, max_views=params.max_views)
    own = read_stereo(paths[keyframe])
    inverse_depth, slope = confirm_matches(
        own.inverse_depth,
        own.slope,
        own.cost,
        agreeing,
        max_cost=params.max_cost,
        min_agreeing=params.min_agreeing,
    )
    share = 100 * np.isfinite(inverse_depth).mean()
    job.progress.note(f"{keyframe}: {share:.0f} % of the pixels have a match that others confirm")
    write_stereo(checked, StereoMap(inverse_depth, slope, own.cost), job.header)
