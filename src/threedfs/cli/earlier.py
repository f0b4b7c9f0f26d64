"""What jobs cost in the earlier runs of a folder, from the records of the store."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from statistics import mean, median
from typing import Any

from threedfs.cli.costs import MEASURED, Cost, Costs, Size
from threedfs.io.keyframes import read_keyframes
from threedfs.io.poses import read_poses
from threedfs.run_end.logs import Action, read_jobs
from threedfs.store.digests import digest_value
from threedfs.store.kernels import ENDING

_START = 1.5
"""Seconds in which a job starts, which its record in the store does not count."""


def find_costs(out: Path, quality: str, config: Mapping[str, Any], cores: int) -> Costs:
    """Return what the jobs of a run will cost: as in earlier ones with the same parameters, if there are any.

    Of several earlier sequences the median counts, for each job; what none of them has costs as was measured.

    Parameters
    ----------
    out : Path
        Folder that holds results/.
    quality : str
    config : mapping
        The whole configuration of the run.
    cores : int
        Of the run.
    """
    store, measured = out / str(config["store"]), MEASURED[quality]
    found: dict[str, list[list[float]]] = defaultdict(list)
    for poses in sorted((out / "results").glob("*/02_poses")):
        try:
            own = _recall(poses.parent, store, measured, config, cores)
        except Exception:  # results or records are damaged: an estimate must not end a run
            continue
        for rule, seconds in own.items():
            many = len(measured.jobs[rule])
            if len(seconds) >= many:
                found[rule].append(seconds if many > 1 else [mean(seconds)])
    typical = {rule: [median(each) for each in zip(*runs, strict=True)] for rule, runs in found.items()}
    cold = not any((store / "kernels").glob("*/*"))
    return replace(measured.with_seconds(typical), cold=cold)


def measure_size(folder: Path) -> Size:
    """Return how large the input of a sequence is, by what lies in the folder of its results."""
    try:
        poses = read_poses(folder / "02_poses/poses.json")
        cameras = [keyframe.view.camera for keyframe in read_keyframes(folder / "04_crops/keyframes.json").values()]
    except Exception:  # not there yet, or damaged: an estimate must not end a run
        return Size()
    frames = len(poses.views) + len(poses.unposed)
    return Size(frames, len(cameras), mean(camera.width * camera.height for camera in cameras) if cameras else None)


def _recall(
    folder: Path, store: Path, measured: Costs, config: Mapping[str, Any], cores: int
) -> dict[str, list[float]]:
    """Return the seconds of a sequence's jobs by rule, on an input of the size of what was measured."""
    jobs, size = read_jobs(folder, store), measure_size(folder)
    if any(_differs(action.record, config) for job in jobs for action in job):
        return {}
    seconds: dict[str, list[float]] = defaultdict(list)
    for job in jobs:
        rule = job[0].rule if _each_keyframe(job) else job[0].record["stage"]
        if known := measured.jobs.get(rule):
            cost = known[min(len(seconds[rule]), len(known) - 1)]
            growth = size.growth(measured.size, cost.grows)
            seconds[rule].append(_cost_of(job, cost, cores, store) * growth)
    return seconds


def _differs(record: Mapping[str, Any], config: Mapping[str, Any]) -> bool:
    """Say whether an action was done with other parameters than the run is to have."""
    own = config.get(record["stage"], {})
    return any(own.get(name, value) != value for name, value in record["parameters"].items())


def _each_keyframe(job: list[Action]) -> bool:
    return "keyframe" in job[0].record["wildcards"]


def _cost_of(job: list[Action], known: Cost, cores: int, store: Path) -> float:
    """Return the wall time of a job with kernels that are compiled."""
    if _each_keyframe(job):
        by_stage = defaultdict(list)
        for action in job:
            by_stage[action.record["stage"]].append(action.record["seconds"])
        # the first keyframe of each process waits for kernels, the others do not
        return _START + sum(median(seconds) * len(seconds) for seconds in by_stage.values()) / cores
    seconds = sum(action.record["seconds"] for action in job)
    if any(_compiled(action, store) for action in job):
        seconds = max(seconds - known.compiling, seconds / 3)
    return _START + seconds


def _compiled(action: Action, store: Path) -> bool:
    """Say whether the job of an action had to compile its kernels: they are as young as its record."""
    maker = {name: action.record[name] for name in ("code", "versions")}
    kernels = (store / "kernels" / digest_value([maker])[:16]).rglob(f"*{ENDING}")
    begun = action.recorded - action.record["seconds"]
    return any(begun <= kernel.stat().st_mtime <= action.recorded for kernel in kernels)
