"""What was measured on which sequences by which methods, and what failed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Metric:
    """One figure.

    Attributes
    ----------
    name : str
        docs/formats.md lists them.
    value : float
    unit : str
        "1" for a share of one.
    dataset, sequence, method : str
        What it was measured on; empty where it does not apply.
    keyframe : str
        The frame it belongs to; empty for a figure of the whole sequence.
    """

    name: str
    value: float
    unit: str
    dataset: str = ""
    sequence: str = ""
    method: str = ""
    keyframe: str = ""


@dataclass(frozen=True)
class Failure:
    """A job that ended without its result.

    Attributes
    ----------
    sequence, stage : str
    item : str
        The keyframe or method that the job was for; empty if it was for the sequence.
    sentence : str
        Why.
    """

    sequence: str
    stage: str
    item: str
    sentence: str

    def __str__(self) -> str:
        return f"failed: {self.stage}: {self.sentence}"


@dataclass(frozen=True)
class Scores:
    """Figures of whole sequences, by sequence, method and name.

    Attributes
    ----------
    metrics : tuple of Metric
        Those without a method are of the sequence whatever the method: costs, poses, depth maps.
    datasets : mapping of str to str
        The data set of every sequence of the run, also of those that failed; its order is that of the tables.
    methods : tuple of str
        Those that make meshes.
    failures : tuple of Failure
    seed : int
        Of the confidence intervals.
    """

    metrics: tuple[Metric, ...]
    datasets: Mapping[str, str]
    methods: tuple[str, ...]
    failures: tuple[Failure, ...] = ()
    seed: int = 0

    @cached_property
    def _values(self) -> dict[tuple[str, str, str], float]:
        return {(row.sequence, row.method, row.name): row.value for row in self.metrics if not row.keyframe}

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the figures of whole sequences, each once, in order of appearance."""
        return tuple(dict.fromkeys(name for _, _, name in self._values))

    @cached_property
    def all_datasets(self) -> tuple[str, ...]:
        """The data sets, each once."""
        return tuple(dict.fromkeys(self.datasets.values()))

    @cached_property
    def measured(self) -> frozenset[str]:
        """Sequences with figures of a method."""
        return frozenset(sequence for sequence, method, _ in self._values if method)

    def sequences(self, dataset: str) -> tuple[str, ...]:
        """Return the sequences of a data set."""
        return tuple(sequence for sequence, own in self.datasets.items() if own == dataset)

    @cached_property
    def variants(self) -> tuple[str, ...]:
        """Names of the variants of methods that were measured or failed, each once: `METHOD@VARIANT` without METHOD."""
        named = [method for _, method, _ in self._values] + [failure.item for failure in self.failures]
        return tuple(dict.fromkeys(name.partition("@")[2] for name in named if "@" in name))

    def value(self, sequence: str, method: str, name: str) -> float | None:
        """Return a figure, or None if there is none; without a method, one that all methods share."""
        return self._values.get((sequence, method, name))

    def excuse(self, sequence: str, method: str) -> str:
        """Say why a sequence lacks a figure of a method: it failed, it is not finished, or nothing (empty).

        A job for another method or variant is no reason; one for a keyframe is.
        """
        for failure in self.failures:
            own, _, variant = failure.item.partition("@")
            if failure.sequence == sequence and (failure.item == method or not (variant or own in self.methods)):
                return str(failure)
        return "" if sequence in self.measured else "not finished"
