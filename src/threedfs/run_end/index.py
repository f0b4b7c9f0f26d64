"""The page over all sequences of a folder of results."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from threedfs.evaluate.scores import Metric
from threedfs.evaluate.summary import COLUMNS
from threedfs.io.atomic import atomic
from threedfs.report.index_page import Row, write_index
from threedfs.run_end.summary import Summary, read_summary


def write_index_page(results: Path, sequences: Iterable[str], metrics: Sequence[Metric]) -> None:
    """Write `index.html`: the sequences of a run in their order, then others that have a report, by name.

    Parameters
    ----------
    results : Path
    sequences : iterable of str
        Of the run.
    metrics : sequence of Metric
        Of all sequences.
    """
    own = list(sequences)
    others = sorted(path.parent.name for path in results.glob("*/report.html") if path.parent.name not in own)
    figures: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for metric in metrics:
        if not metric.keyframe:
            figures[metric.sequence, metric.method][metric.name] = metric.value
    rows = [_describe(results / name, figures) for name in (*own, *others)]
    with atomic(results / "index.html") as temporary:
        temporary.write_text(write_index(rows, [title for title, _, _ in COLUMNS]), encoding="utf-8")


def _describe(folder: Path, figures: Mapping[tuple[str, str], Mapping[str, float]]) -> Row:
    name, summary = folder.name, read_summary(folder) or Summary(verdict="not finished")
    method = summary.method or next((each for each in summary.methods if (name, each) in figures), "")
    found = {**figures.get((name, ""), {}), **figures.get((name, method), {})}
    return Row(
        name,
        f"{name}/report.html" if (folder / "report.html").is_file() else "",
        summary.picture,
        " ".join(summary.failures) or summary.verdict or "no mesh",
        False if summary.failures else summary.good,
        {title: format(found[key], form) for title, key, form in COLUMNS if key in found},
    )
