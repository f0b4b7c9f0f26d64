"""Score the depth experiment of one sequence: all methods over all of its trials (Section 4.2)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from threedfs.errors import UserError
from threedfs.evaluate.depth_error import DepthPairs, pair_depths, pool_pairs
from threedfs.evaluate.depth_experiment import experiment_figures, find_object_depths
from threedfs.evaluate.figures import Figure
from threedfs.evaluate.scores import Metric
from threedfs.io.depth_trials import DepthTrial, read_depth_trial
from threedfs.io.metrics import DEPTH_METHODS, write_metrics
from threedfs.job import Job
from threedfs.params.depth_experiment import DepthExperimentParams


def run(
    *,
    trials: list[Path] | None,
    metrics: Path,
    dataset: str,
    sequence: str,
    params: DepthExperimentParams,
    job: Job,
) -> None:
    """Read the trials of a sequence; write metrics.csv.

    Raises
    ------
    UserError
        If there is no trial.
    """
    if not trials:
        raise UserError(
            "expected true depth images (truth.depth) of keyframes, found none for any keyframe; name them "
            "NAME.depth.png after frames that become keyframes: with keyframes_at_truth, those with a true mask do."
        )
    read = {path.name.removesuffix(".zarr.zip"): read_depth_trial(path) for path in trials}
    methods = next(iter(read.values())).methods
    table = [
        Metric(item.name, item.value, item.unit, dataset, sequence, f"{DEPTH_METHODS}{method}", item.keyframe)
        for number, method in enumerate(methods)
        for item in _score(read, number, params)
    ]
    write_metrics(metrics, table)
    job.progress.note(f"{len(methods)} methods on {len(read)} keyframes of {params.keyframes} asked for")


def _score(trials: dict[str, DepthTrial], number: int, params: DepthExperimentParams) -> list[Figure]:
    everywhere = {name: pair_depths(trial.depth[number], trial.truth) for name, trial in trials.items()}
    on_object = {name: trial.on_object for name, trial in trials.items()}
    regions = {}
    if any(mask.any() for mask in on_object.values()):
        near = {name: find_object_depths(trial.truth, trial.on_object) for name, trial in trials.items()}
        regions = {
            "object_depth": _pool(trials, number, on_object),
            "object_range_depth": _pool(trials, number, near),
        }
    return experiment_figures(everywhere, regions, params.bin_width, "truth unit")


def _pool(trials: dict[str, DepthTrial], number: int, where: dict[str, np.ndarray]) -> DepthPairs:
    return pool_pairs(
        [pair_depths(trial.depth[number], np.where(where[name], trial.truth, np.nan)) for name, trial in trials.items()]
    )
