"""A table with a row for every sequence of a data set, and what sums them up."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from threedfs.evaluate.bootstrap import mean_interval
from threedfs.evaluate.scores import Scores
from threedfs.evaluate.table import Table

NOTHING = "-"
INTERVAL_NOTE = (
    "In brackets: 95 % confidence interval of the mean over sequences, by bootstrap. Means and medians are over the "
    "sequences with a figure."
)


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    title : str
    name : str
        The figure.
    form : str
        How it is written.
    method : str
        Empty for figures that all methods share.
    factor : float
        What the figure is multiplied by.
    """

    title: str
    name: str
    form: str = ".3f"
    method: str = ""
    factor: float = 1.0


@dataclass(frozen=True)
class SequenceRows:
    """Figures of sequences.

    Attributes
    ----------
    scores : Scores
    columns : tuple of Column
    values : dict of str to list of float or None
        By sequence, a value for each column.
    """

    scores: Scores
    columns: tuple[Column, ...]
    values: dict[str, list[float | None]]

    @classmethod
    def find(cls, scores: Scores, dataset: str, columns: Iterable[Column]) -> SequenceRows:
        """Look up the figures of a data set's sequences."""
        columns = tuple(columns)

        def value(sequence: str, column: Column) -> float | None:
            found = scores.value(sequence, column.method, column.name)
            return None if found is None else column.factor * found

        values = {sequence: [value(sequence, column) for column in columns] for sequence in scores.sequences(dataset)}
        return cls(scores, columns, values)

    @property
    def measured(self) -> bool:
        """Whether there is any figure."""
        return any(pick(row) for row in self.values.values())

    def render(
        self, title: str, footers: Sequence[str] = ("mean",), note: str = INTERVAL_NOTE, reasons: bool = True
    ) -> Table:
        """Return the table.

        Parameters
        ----------
        title : str
        footers : sequence of str
            Rows below, from `FOOTERS`.
        note : str
        reasons : bool
            Whether a sequence without a figure tells why: "failed: stage: sentence" in the first such cell, "failed"
            in the next.
        """
        rows = [(sequence, *self._cells(sequence, reasons)) for sequence in self.values]
        failed = sum(any(cell.startswith("failed:") for cell in cells) for _, *cells in rows)
        for footer in footers:
            rows.append((footer, *(self._foot(footer, number) for number in range(len(self.columns)))))
        if failed:
            note = f"{failed} of {len(self.values)} sequences failed. {note}"
        return Table(title, ("sequence", *(column.title for column in self.columns)), tuple(rows), note)

    def _cells(self, sequence: str, reasons: bool) -> list[str]:
        cells: list[str] = []
        for column, value in zip(self.columns, self.values[sequence], strict=True):
            reason = self.scores.excuse(sequence, column.method) if reasons else ""
            text = (reason or NOTHING) if value is None else format(value, column.form)
            cells.append("failed" if text.startswith("failed:") and text in cells else text)
        return cells

    def _foot(self, footer: str, number: int) -> str:
        return FOOTERS[footer](
            pick(row[number] for row in self.values.values()), self.columns[number].form, self.scores.seed
        )


def pick(values: Iterable[float | None]) -> list[float]:
    """Return the values that are there."""
    return [value for value in values if value is not None]


def format_mean(values: Sequence[float], form: str, seed: int) -> str:
    """Return the mean with its confidence interval, "-" without values.

    Examples
    --------
    >>> format_mean([0.5, 0.7], ".2f", 0), format_mean([0.5], ".2f", 0), format_mean([], ".2f", 0)
    ('0.60 [0.50, 0.70]', '0.50', '-')
    """
    if not values:
        return NOTHING
    mean = format(float(np.mean(values)), form)
    low, high = mean_interval(np.array(values), np.random.default_rng(seed))
    return mean if math.isnan(low) else f"{mean} [{low:{form}}, {high:{form}}]"


def _format_by(combine: Callable[[Sequence[float]], float]) -> Callable[[Sequence[float], str, int], str]:
    return lambda values, form, seed: format(float(combine(values)), form) if values else NOTHING


FOOTERS = {
    "mean": format_mean,
    "median": _format_by(np.median),
    "total": _format_by(sum),
    "largest": _format_by(max),
}
"""What may stand below a table: functions of values, form and seed."""
