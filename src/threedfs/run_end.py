"""What a run says when it ends: the figures and costs of its sequences, or why it stopped."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

from threedfs.evaluate.costs import cost_figures
from threedfs.evaluate.summary import DEPTH_COLUMNS, render_summary
from threedfs.io.metrics import DEPTH_METHODS, Metric, read_metrics, write_metrics


def summarise_run(results: Path, store: Path, since: float) -> str:
    """Lay out the figures of all sequences for the terminal, and write their costs to benchmarks/costs.csv.

    Costs are those of the work when it was done, also for what was then taken from the store.

    Parameters
    ----------
    results, store : Path
    since : float
        Without a table of metrics written after this time, seconds since the epoch, nothing is said or written.
    """
    table = results / "metrics.csv"
    if not table.is_file() or table.stat().st_mtime < since:
        return ""
    metrics = read_metrics(table)
    costs = {name: cost_figures(_read_actions(results / name, store)) for name in {m.sequence for m in metrics}}
    write_metrics(
        results / "benchmarks" / "costs.csv",
        [
            Metric(cost.name, cost.value, cost.unit, sequence=name)
            for name, figures in sorted(costs.items())
            for cost in figures
        ],
    )
    objects: dict[str, dict[str, float]] = defaultdict(dict)
    depths: dict[str, dict[str, float]] = defaultdict(dict)
    for metric in metrics:
        of_depth = metric.method.startswith(DEPTH_METHODS)
        figures = (depths if of_depth else objects)[f"{metric.sequence} {metric.method}"]
        if not metric.keyframe:
            figures[metric.name] = metric.value
        if not of_depth:
            figures |= {cost.name: cost.value for cost in costs[metric.sequence]}
    blocks = [render_summary(objects)] if objects else []
    blocks += [render_summary(depths, DEPTH_COLUMNS)] if depths else []
    return "\n" + "\n\n".join([*blocks, f"All figures: {table}; seconds are of all cores together.\n"])


def find_failures(results: Path, since: float) -> str:
    """Collect, one a line, the sentences with which jobs refused their input after a time.

    Parameters
    ----------
    results : Path
        Holds the logs.
    since : float
        Seconds since the epoch.
    """
    sentences = []
    for log in _find_logs(results):
        if log.stat().st_mtime >= since:
            lines = log.read_text(encoding="utf-8", errors="replace").splitlines(keepends=True)
            sentences += [line for line in lines if line.startswith("threedfs: ")]
    return "".join(sentences)


def _read_actions(folder: Path, store: Path) -> list[dict]:
    """Read the records of the actions whose keys the logs of a sequence end with."""
    keys = set()
    for log in _find_logs(folder):
        last = log.read_text(encoding="utf-8", errors="replace").rstrip().rpartition("\n")[2]
        if last.startswith("action "):
            keys.add(last.removeprefix("action "))
    records = (store / "actions" / key[:2] / f"{key}.json" for key in sorted(keys))
    return [json.loads(record.read_text()) for record in records if record.is_file()]


def _find_logs(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*.log") if "logs" in path.relative_to(folder).parts)
