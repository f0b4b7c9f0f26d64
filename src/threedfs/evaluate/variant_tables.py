"""What the variants of the joint segmentation change: a table for each method."""

from __future__ import annotations

from threedfs.evaluate.scores import Scores
from threedfs.evaluate.sequence_rows import NOTHING, format_mean
from threedfs.evaluate.table import Table

_HEADER = ("variant", "IoU mean", "change", "worst", "best", "lower on", "sequences")


def variant_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return how far each variant changes the foreground IoU; none, where none was measured."""
    tables = (_compare(scores, dataset, method) for method in scores.methods)
    return [table for table in tables if table is not None]


def _compare(scores: Scores, dataset: str, method: str) -> Table | None:
    sequences = scores.sequences(dataset)
    base = {name: scores.value(name, method, "iou_mean") for name in sequences}
    base = {name: value for name, value in base.items() if value is not None}
    rows = []
    for variant in scores.variants:
        found = {name: scores.value(name, f"{method}@{variant}", "iou_mean") for name in base}
        change = {name: value - base[name] for name, value in found.items() if value is not None}
        if change:
            mean = sum(base[name] + step for name, step in change.items()) / len(change)
            rows.append((variant, f"{mean:.3f}", *_sum_up(change, scores.seed), f"{len(change)} of {len(sequences)}"))
    if not rows:
        return None
    mean = sum(base.values()) / len(base)
    plain = ("as configured", f"{mean:.3f}", *[NOTHING] * 4, f"{len(base)} of {len(sequences)}")
    failed = [
        f"{item.sequence} {item.item} {item}" for item in scores.failures if "@" in item.item and item.sequence in base
    ]
    note = (
        "Change against the configured method over the sequences that both have; in brackets its 95 % confidence "
        "interval, by bootstrap. The variants are those of the configuration."
    )
    title = f"Foreground IoU over keyframes by variants of {method}, {dataset}"
    return Table(title, _HEADER, (plain, *rows), " ".join([note, *failed]))


def _sum_up(change: dict[str, float], seed: int) -> tuple[str, str, str, str]:
    worst, best = (choose(change, key=change.__getitem__) for choose in (min, max))
    ends = (f"{change[name]:+.3f} {name}" for name in (worst, best))
    lower = sum(step < 0 for step in change.values())
    return (format_mean(list(change.values()), "+.3f", seed), *ends, str(lower))
