"""The tables printed at the end of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from threedfs.evaluate.scores import Scores
from threedfs.evaluate.sequence_rows import FOOTERS, pick

COLUMNS = (
    ("IoU mean", "iou_mean", ".3f"),
    ("median", "iou_median", ".3f"),
    ("min", "iou_min", ".3f"),
    ("other frames", "iou_frames_mean", ".3f"),
    ("unseen IoU", "iou_unseen_mean", ".3f"),
    ("depth error %", "depth_error_median", ".2f"),
    ("F-score 1 %", "mesh_f_score_1", ".3f"),
    ("centre error %", "pose_centre_error_median", ".2f"),
    ("rotation deg", "pose_rotation_error_median", ".2f"),
    ("turns", "path_turns", ".2f"),
    ("can side %", "cylinder_residual_median", ".2f"),
    ("closed", "mesh_closed", ".0f"),
    ("seconds", "seconds", ".0f"),
)
"""Titles, names and forms of the figures that say most."""


def render_summary(tables: Mapping[str, Mapping[str, float]]) -> str:
    """Return one line for each sequence and method, with the figures that at least one of them has.

    Parameters
    ----------
    tables : mapping of str to mapping of str to float
        For each label of a line (sequence and method), the figures of the whole sequence by name.

    Examples
    --------
    >>> print(render_summary({"can": {"iou_mean": 0.93}, "toy rabbit": {}}))
                IoU mean
    can            0.930
    toy rabbit         -
    """
    columns = [column for column in COLUMNS if any(column[1] in figures for figures in tables.values())]
    rows = [["", *(title for title, _, _ in columns)]]
    for label, figures in tables.items():
        rows.append([label, *(format(figures[name], form) if name in figures else "-" for _, name, form in columns)])
    return _align(rows)


def render_overlap(scores: Scores) -> str:
    """Return one line for each data set and method: mean, its confidence interval, and median of the IoU.

    Examples
    --------
    >>> from threedfs.evaluate.scores import Metric
    >>> rows = (Metric("iou_mean", 0.9, "1", "toys", "mug", "fused_sdf"),)
    >>> print(render_overlap(Scores(rows, {"mug": "toys", "can": "toys"}, ("fused_sdf",))))
                    IoU mean  median  sequences
    toys fused_sdf     0.900   0.900     1 of 2
    """
    rows = [["", "IoU mean", "median", "sequences"]]
    for dataset in scores.all_datasets:
        sequences = scores.sequences(dataset)
        for method in scores.methods:
            values = pick(scores.value(sequence, method, "iou_mean") for sequence in sequences)
            ends = (FOOTERS[footer](values, ".3f", scores.seed) for footer in ("mean", "median"))
            rows.append([f"{dataset} {method}", *ends, f"{len(values)} of {len(sequences)}"])
    return _align(rows)


def _align(rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
