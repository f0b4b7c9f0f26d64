"""The tidy table of figures: one row a figure."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.evaluate.scores import Metric
from threedfs.io.atomic import atomic

DEPTH_METHODS = "depth/"
"""How methods of the depth experiment begin, to tell them from those that cut out an object."""


COLUMNS = tuple(field.name for field in fields(Metric))


def write_metrics(path: Path, metrics: Iterable[Metric]) -> None:
    """Write the table as CSV; values carry nine significant digits, so that equal figures have equal bytes."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for metric in metrics:
        row = [getattr(metric, column) for column in COLUMNS]
        row[1] = f"{metric.value:.9g}"
        writer.writerow(row)
    with atomic(path) as temporary:
        temporary.write_text(text.getvalue(), encoding="utf-8", newline="")


def read_metrics(path: Path) -> list[Metric]:
    """Read a table written by `write_metrics`.

    Raises
    ------
    UserError
        If the file is missing, its columns differ, or a value is no number.
    """
    path = Path(path)
    if not path.is_file():
        raise UserError(f"{path}: expected a table of metrics, found none; rule evaluate writes it.")
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    if not rows or tuple(rows[0]) != COLUMNS:
        raise UserError(f"{path}: expected the columns {','.join(COLUMNS)}, got {','.join(rows[0] if rows else [])}.")
    metrics = []
    for line, row in enumerate(rows[1:], start=2):
        try:
            values: dict[str, Any] = dict(zip(COLUMNS, row, strict=True))
            metrics.append(Metric(**{**values, "value": float(values["value"])}))
        except ValueError:
            raise UserError(
                f"{path}: expected {len(COLUMNS)} columns with a number as value in line {line}, got {','.join(row)}."
            ) from None
    return metrics
