"""What a run leaves and says when it ends, well or not: tables, plots, a summary, and why jobs failed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from threedfs.errors import UserError
from threedfs.evaluate.costs import cost_figures
from threedfs.evaluate.doubts import doubt_tables
from threedfs.evaluate.experiment_tables import experiment_tables, group_experiments
from threedfs.evaluate.plots import plot_depth_experiment, plot_overlap
from threedfs.evaluate.scores import Metric, Scores
from threedfs.evaluate.summary import render_overlap, render_summary
from threedfs.evaluate.table import Table, render_markdown
from threedfs.evaluate.tables import (
    cost_tables,
    depth_tables,
    mesh_tables,
    overlap_tables,
    pose_tables,
    unseen_tables,
)
from threedfs.evaluate.variant_tables import variant_tables
from threedfs.io.atomic import atomic
from threedfs.io.metrics import read_metrics, write_metrics
from threedfs.params.configuration import METHODS
from threedfs.params.schema import STAGES
from threedfs.run_end.due import is_due
from threedfs.run_end.index import write_index_page
from threedfs.run_end.logs import find_failures, read_actions
from threedfs.store.files import remove

_SCORING = {"evaluate", "evaluate_reconstruction", "photographs", "depth_trial", "depth_experiment", "collect"}
"""Stages that compare and make nothing."""
_SCORES = ("12_evaluate/**/*.csv", "12_depth_experiment/metrics.csv")
"""Tables of figures of a sequence."""

TABLES = {
    "iou": overlap_tables,
    "variants": variant_tables,
    "iou_unseen": unseen_tables,
    "depth_experiment": experiment_tables,
    "poses": pose_tables,
    "meshes": mesh_tables,
    "depth": depth_tables,
    "doubts": doubt_tables,
}
"""Files of tables, by name, in the order in which they are read."""


@dataclass(frozen=True)
class Run:
    """What a run was to do.

    Attributes
    ----------
    results, store : Path
    started : float
        Seconds since the epoch.
    datasets : mapping of str to str
        The data set of each sequence.
    methods : tuple of str
    tables : tuple of Path
        The tables of metrics that rule collect puts together.
    seed : int
        Of the confidence intervals.
    changes : mapping of str to mapping of str to str
        Of each sequence, the settings that differ from the defaults.
    versions : mapping of str to str
        Of the libraries.
    threads : int
        Draw the reports; their number changes nothing in them.
    """

    results: Path
    store: Path
    started: float
    datasets: Mapping[str, str]
    methods: tuple[str, ...]
    tables: tuple[Path, ...]
    seed: int
    changes: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)
    threads: int = 1

    @property
    def collected(self) -> Path:
        """The table of all figures, which rule collect makes; a run with a failure takes it away."""
        return self.results / "tables" / "metrics.csv"


def finish_run(run: Run, unfinished: Collection[str] = ()) -> str:
    """Write the tables and plots of the sequences that have their figures; return what the run says at its end.

    Below `results`: `metrics.csv` (all figures), `tables/*.md`, `plots/*.svg`; and what differs from run to run,
    `benchmarks/costs.csv` and `costs.md`. They hold the sequences of the run, and after them those of earlier runs
    whose figures still lie in their folders. Costs are those of the work when it was done, also for what was then
    taken from the store. If a job failed, the tables name it. `tables/metrics.csv`, which rule collect makes, is then
    taken away: the next run collects anew.

    Parameters
    ----------
    run : Run
    unfinished : collection of str
        Outputs of jobs that the run should have done and did not. Where they are there, they are out of date.

    Returns
    -------
    str
        Only the failures, if the run was not to collect figures.
    """
    failures = find_failures(run.results, run.started)
    refused = "".join(
        f"threedfs: {failure.stage} of {' '.join(filter(None, (failure.sequence, failure.item)))}: {failure.sentence}\n"
        for failure in failures
    )
    _remove_stale(run, unfinished, {failure.sequence for failure in failures})
    if str(run.collected) in unfinished:
        run.collected.unlink(missing_ok=True)
    elif not run.collected.is_file() or run.collected.stat().st_mtime < run.started:
        return refused
    own, others = _read_own(run, unfinished), _read_others(run)
    datasets = {**run.datasets, **{row.sequence: row.dataset for row in others}}
    costs = [
        Metric(cost.name, cost.value, cost.unit, dataset, sequence)
        for sequence, dataset in datasets.items()
        for cost in cost_figures(read_actions(run.results / sequence, run.store))
    ]
    write_metrics(run.results / "benchmarks" / "costs.csv", costs)
    write_metrics(run.results / "metrics.csv", [*own, *others])
    used = {row.method for row in others} - {*run.methods}
    methods = (*run.methods, *(method for method in METHODS if method in used))
    scores = Scores((*own, *others, *costs), datasets, methods, tuple(failures), run.seed)
    _write_all(run.results / "tables", ".md", _lay_out(scores, TABLES))
    by_stage = {"costs": lambda scores, dataset: cost_tables(scores, dataset, STAGES)}
    _write_all(run.results / "benchmarks", ".md", _lay_out(scores, by_stage))
    _write_all(run.results / "plots", ".svg", _draw_plots(scores))
    said = tuple(row for row in (*own, *costs) if row.sequence in run.datasets)
    told = _summarise(Scores(said, run.datasets, run.methods, tuple(failures), run.seed))
    if failures:
        run.collected.unlink(missing_ok=True)
    places = f"Reports: {run.results}/index.html\nTables and plots: {run.results}/tables, {run.results}/plots"
    return f"\n{told}\n\n{places}\n{refused}"


def _read_own(run: Run, unfinished: Collection[str]) -> list[Metric]:
    """Read the figures of the run's sequences, without those that are out of date."""
    current = [path for path in run.tables if path.is_file() and str(path) not in unfinished]
    return [metric for path in current for metric in read_metrics(path)]


def _read_others(run: Run) -> list[Metric]:
    """Read the figures of sequences that are not in the run, in the order of their names.

    Tables that cannot be read are left out.
    """
    metrics = []
    for folder in sorted(path for path in run.results.glob("*") if path.is_dir() and path.name not in run.datasets):
        for path in (path for pattern in _SCORES for path in sorted(folder.glob(pattern))):
            try:
                metrics += [metric for metric in read_metrics(path) if metric.sequence == folder.name]
            except UserError:  # of another version, or damaged: its sequence is not in this run, which goes on
                continue
    return metrics


def _remove_stale(run: Run, unfinished: Collection[str], failed: Collection[str]) -> None:
    """Remove what would pass for results of now: scores of sequences that failed, textures of a mesh before the last.

    The next run that wants them takes them from the store, or makes them.
    """
    for path in run.tables:
        if str(path) in unfinished and path.relative_to(run.results).parts[0] in failed:
            path.unlink(missing_ok=True)
    for mesh in (mesh for name in run.datasets for mesh in (run.results / name).glob("11_object/*/mesh.ply")):
        made = mesh.stat().st_mtime_ns
        if made < run.started * 1e9:  # in a copy of results, times say nothing
            continue
        painted = mesh.parent / "textured"
        times = [path.stat().st_mtime_ns for path in painted.rglob("*")]
        if times and max(times) < made:
            remove(painted)
            remove(mesh.parent / "mesh.glb")


def report_run(run: Run, unfinished: Collection[str], note: Callable[[str], object]) -> None:
    """Write `report.html` into the folder of each sequence that changed or failed, and `index.html` over all of them.

    Parameters
    ----------
    run : Run
    unfinished : collection of str
        As `finish_run` takes them.
    note : callable
        Takes a sentence for a report that could not be made.
    """
    failures = find_failures(run.results, run.started)
    failed = {failure.sequence for failure in failures}
    complete = not failures and not unfinished and run.collected.is_file()
    due = [
        run.results / name
        for name in run.datasets
        if name in failed or is_due(run.results / name, run.methods, complete)
    ]
    own = _read_own(run, unfinished)

    def describe(sequence: str):
        from threedfs.run_end.report import Context

        stages = {failure.stage for failure in failures if failure.sequence == sequence}
        return Context(
            run.store,
            [metric for metric in own if metric.sequence == sequence],
            [f"{failure.stage}: {failure.sentence}" for failure in failures if failure.sequence == sequence],
            run.methods,
            unfinished,
            stages <= _SCORING,
            run.changes.get(sequence, {}),
            run.versions,
            run.threads,
        )

    if due:
        # what draws pictures takes a second to import, which a run with nothing to do is spared
        from threedfs.run_end.report import write_reports

        write_reports(due, describe, note)
    write_index_page(run.results, run.datasets, [*own, *_read_others(run)])


def _lay_out(scores: Scores, makers: Mapping[str, Callable[[Scores, str], list[Table]]]) -> dict[str, str]:
    texts = {}
    for name, make in makers.items():
        tables = [table for dataset in scores.all_datasets for table in make(scores, dataset)]
        if tables:
            texts[name] = "\n".join(render_markdown(table) for table in tables)
    return texts


def _draw_plots(scores: Scores) -> dict[str, str]:
    plots = {}
    for dataset in scores.all_datasets:
        plots[f"iou_{dataset}"] = plot_overlap(scores, dataset)
        for count in group_experiments(scores):
            plots[f"depth_{dataset}_{count}"] = plot_depth_experiment(scores, dataset, count)
    return {name: plot for name, plot in plots.items() if plot}


def _write_all(folder: Path, suffix: str, texts: Mapping[str, str]) -> None:
    """Write files of a suffix, and remove those of earlier runs that there is nothing for now."""
    for name, text in texts.items():
        with atomic(folder / f"{name}{suffix}") as temporary:
            temporary.write_text(text, encoding="utf-8")
    for path in folder.glob(f"*{suffix}"):
        if path.stem not in texts:
            path.unlink()


def _summarise(scores: Scores) -> str:
    own: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for row in scores.metrics:
        if not row.keyframe:
            own[row.sequence, row.method][row.name] = row.value
    lines = {
        f"{sequence} {method}": {**own[sequence, ""], **figures}
        for (sequence, method), figures in list(own.items())
        if method in scores.methods
    }
    parts = [render_summary(lines)] if lines else []
    parts += [render_overlap(scores)] if len(scores.datasets) > 1 else []
    doubts = [row for dataset in scores.all_datasets for table in doubt_tables(scores, dataset) for row in table.rows]
    parts += ["\n".join(f"doubtful truth of {row[0]}, {row[1]}: {row[2]}" for row in doubts)] if doubts else []
    return "\n\n".join([*parts, _sum_up_costs(scores)])


def _sum_up_costs(scores: Scores) -> str:
    totals = {
        kind: [row.value for row in scores.metrics if not row.method and row.name.startswith(kind)]
        for kind in ("seconds_", "peak_memory_", "bytes_")
    }
    return (
        f"Cost when the work was done: {sum(totals['seconds_']):.0f} s of all jobs together, at most "
        f"{max(totals['peak_memory_'], default=0):.0f} MB in a job, {sum(totals['bytes_']) / 1e6:.0f} MB written."
    )
