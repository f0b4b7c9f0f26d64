"""Figures so bad that the truth may belong to something else."""

from __future__ import annotations

from collections.abc import Mapping

from threedfs.evaluate.scores import Scores
from threedfs.evaluate.table import Table

_WORST_ROTATION, _WORST_FAR_SHARE, _WORST_OVERLAP = 10.0, 60.0, 0.5
"""Degrees, %, IoU: the worst sequence that is understood has 1 degree, 45 % and 0.83."""


def find_doubts(figures: Mapping[str, float]) -> list[str]:
    """Return what makes a truth doubtful, by the figures of a sequence, or of one method on it.

    Examples
    --------
    >>> find_doubts({"iou_mean": 0.05, "masks_inverted": 20.0})
    ['20 true masks agree better when inverted: white must be the object']
    >>> find_doubts({"iou_mean": 0.9})
    []
    """
    found = []
    if figures.get("masks_inverted"):
        found.append(f"{figures['masks_inverted']:.0f} true masks agree better when inverted: white must be the object")
    elif figures.get("iou_mean", 1.0) < _WORST_OVERLAP:
        found.append(f"the true masks overlap by {figures['iou_mean']:.2f} only: are they of this sequence?")
    if figures.get("pose_rotation_error_median", 0.0) > _WORST_ROTATION:
        found.append(
            f"the true cameras look {figures['pose_rotation_error_median']:.0f} degrees elsewhere in the median: are "
            "they of this sequence?"
        )
    if figures.get("mesh_far_share", 0.0) > _WORST_FAR_SHARE:
        found.append(
            f"{figures['mesh_far_share']:.0f} % of the mesh is far from the true one: is that of this sequence, and "
            "in the coordinates of the true cameras?"
        )
    return found


def doubt_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the sequences of a data set whose truth is doubtful, and why; no table without any."""
    methods = ("", *dict.fromkeys(row.method for row in scores.metrics if row.method))
    rows = []
    for sequence in scores.sequences(dataset):
        for method in methods:
            values = {name: scores.value(sequence, method, name) for name in scores.names}
            figures = {name: value for name, value in values.items() if value is not None}
            rows += [(sequence, method or "-", sentence) for sentence in find_doubts(figures)]
    note = "Either the reconstruction failed, or the truth is not that of the sequence; such figures say nothing."
    return [Table(f"Doubtful truth, {dataset}", ("sequence", "method", "why"), tuple(rows), note)] if rows else []
