"""What a run cost, from the records of its actions.

Costs differ from run to run: they have a table of their own, so that the table of metrics is byte-reproducible.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

from threedfs.evaluate.figures import Figure


def cost_figures(records: Iterable[Mapping[str, Any]]) -> list[Figure]:
    """Return seconds, peak memory and bytes written per stage, then the sum of the seconds.

    Parameters
    ----------
    records : iterable of mapping
        Action records of the store: ``stage``, ``seconds``, ``peak_memory_mb`` and ``bytes`` (by output).

    Examples
    --------
    >>> records = [{"stage": "depth", "seconds": 2.0, "peak_memory_mb": 300, "bytes": {"depth": 10}}] * 2
    >>> [(figure.name, figure.value, figure.unit) for figure in cost_figures(records)]
    [('seconds_depth', 4.0, 's'), ('peak_memory_depth', 300.0, 'MB'), ('bytes_depth', 20.0, 'B'), ('seconds', 4.0, 's')]
    """
    by_stage = defaultdict(list)
    for record in records:
        by_stage[record["stage"]].append(record)
    figures = []
    for stage, jobs in sorted(by_stage.items()):
        figures += [
            Figure(f"seconds_{stage}", float(sum(job["seconds"] for job in jobs)), "s"),
            Figure(f"peak_memory_{stage}", float(max(job["peak_memory_mb"] for job in jobs)), "MB"),
            Figure(f"bytes_{stage}", float(sum(sum(job["bytes"].values()) for job in jobs)), "B"),
        ]
    total = sum(figure.value for figure in figures if figure.name.startswith("seconds_"))
    return [*figures, Figure("seconds", float(total), "s")] if figures else []
