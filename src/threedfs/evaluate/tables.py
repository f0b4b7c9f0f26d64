"""The tables of a benchmark: a row for every sequence, also for those that failed.

Each function returns the tables of one data set; none, where nothing of the kind was measured on it.
"""

from __future__ import annotations

from collections.abc import Sequence

from threedfs.evaluate.paper_table import PRINTED, PRINTED_MEAN, PRINTED_MEDIAN, SEQUENCES
from threedfs.evaluate.scores import Scores
from threedfs.evaluate.sequence_rows import INTERVAL_NOTE, Column, SequenceRows
from threedfs.evaluate.table import Table


def overlap_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the foreground IoU over keyframes, sequences x methods, and what the paper prints for sequences so named.

    References
    ----------
    Table 1.
    """
    rows = SequenceRows.find(scores, dataset, _by_method(scores, "iou_mean"))
    others = frame_tables(scores, dataset)
    if not rows.measured and not others and not any(failure.sequence in rows.values for failure in scores.failures):
        return []
    note = " ".join([INTERVAL_NOTE, *_tell_left_out(scores, dataset)])
    ours = rows.render(f"Foreground IoU over keyframes, {dataset}", ("mean", "median"), note)
    return [ours, *others, *_printed_table(tuple(rows.values))]


def frame_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the IoU of the mesh's silhouette in working frames that are no keyframes."""
    rows = SequenceRows.find(scores, dataset, _by_method(scores, "iou_frames_mean"))
    return [rows.render(f"IoU in other frames, {dataset}", ("mean", "median"))] if rows.measured else []


def unseen_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the IoU of the mesh's silhouette in views that had no image."""
    rows = SequenceRows.find(scores, dataset, _by_method(scores, "iou_unseen_mean"))
    return [rows.render(f"IoU in unseen views, {dataset}", ("mean", "median"))] if rows.measured else []


def pose_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the errors of the cameras after similarity alignment."""
    columns = [
        Column("centre, median, % of path", "pose_centre_error_median"),
        Column("centre, largest", "pose_centre_error_max"),
        Column("rotation, median, degrees", "pose_rotation_error_median"),
        Column("rotation, largest", "pose_rotation_error_max"),
    ]
    note = f"After similarity alignment, so 0 where the reference cameras were given. {INTERVAL_NOTE}"
    return _measured(scores, dataset, columns, f"Poses, {dataset}", note)


def mesh_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return distances, F-scores and soundness of the meshes, a table for each method."""
    agreements = [name for name in scores.names if name.startswith("mesh_f_score_")]
    tables = []
    for method in scores.methods:
        columns = [
            Column("accuracy, % of diagonal", "mesh_accuracy", method=method),
            Column("completeness", "mesh_completeness", method=method),
            Column("Chamfer", "mesh_chamfer", method=method),
            *(Column(f"F-score at {name.rpartition('_')[2]} %", name, method=method) for name in agreements),
            Column("farther than 2 %, %", "mesh_far_share", ".1f", method=method),
            Column("normals, degrees", "mesh_normal_error", ".1f", method=method),
            Column("closed", "mesh_closed", ".0f", method=method),
            Column("pieces", "mesh_pieces", ".0f", method=method),
            Column("handles", "mesh_genus", ".0f", method=method),
            Column("filled", "mesh_filled", ".2f", method=method),
            Column("photographs, PSNR, dB", "photo_psnr", ".1f", method=method),
            Column("SSIM", "photo_ssim", method=method),
        ]
        tables += _measured(scores, dataset, columns, f"Meshes by {method}, {dataset}")
    return tables


def depth_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the errors of the keyframes' depth maps, against the true mesh and against depth images."""
    tables = []
    for name, where in (("depth", "on the object"), ("scene_depth", "over the whole image")):
        columns = [
            Column("relative error, median, %", f"{name}_error_median", ".2f"),
            Column("mean", f"{name}_error_mean", ".2f"),
            Column("pixels within 1 %, %", f"{name}_within_1", ".1f"),
            Column("within 10 %", f"{name}_within_10", ".1f"),
            Column("covered", f"{name}_covered", ".1f"),
            Column("RMSE, unit of the truth", f"{name}_rmse", ".4f"),
        ]
        tables += _measured(scores, dataset, columns, f"Depth {where}, {dataset}")
    return tables


def cost_tables(scores: Scores, dataset: str, stages: Sequence[str]) -> list[Table]:
    """Return seconds, peak memory and bytes written, sequences x stages.

    Parameters
    ----------
    scores : Scores
    dataset : str
    stages : sequence of str
        The order of the columns; stages that are not in it come last.
    """
    found = [name.removeprefix("seconds_") for name in scores.names if name.startswith("seconds_")]
    found.sort(key=lambda stage: stages.index(stage) if stage in stages else len(stages))
    kinds = (
        ("seconds", "Seconds, of all jobs together", ".1f", 1.0, "total"),
        ("peak_memory", "Peak memory of a job, MB", ".0f", 1.0, "largest"),
        ("bytes", "Written, MB", ".1f", 1e-6, "total"),
    )
    note = (
        "What a failed sequence cost counts too; what was taken from the store counts as when it was made. "
        "In brackets: 95 % confidence interval of the mean over sequences, by bootstrap."
    )
    tables = []
    for kind, title, form, factor, footer in kinds:
        columns = [Column(stage, f"{kind}_{stage}", form, factor=factor) for stage in found]
        if kind == "seconds":
            columns.append(Column("all stages", "seconds", form))
        rows = SequenceRows.find(scores, dataset, columns)
        if rows.measured:
            tables.append(rows.render(f"{title}, {dataset}", ("mean", footer), note, reasons=False))
    return tables


def _tell_left_out(scores: Scores, dataset: str) -> list[str]:
    """Return a sentence on the true masks that were scored nowhere, if there are any."""
    counts = {
        (sequence, method): scores.value(sequence, method, "masks_left_out")
        for sequence in scores.sequences(dataset)
        for method in scores.methods
    }
    named = [f"{sequence} {method} {count:.0f}" for (sequence, method), count in counts.items() if count]
    if not named:
        return []
    return [f"True masks at frames where a method has none and no camera is known are left out: {', '.join(named)}."]


def _by_method(scores: Scores, name: str) -> list[Column]:
    return [Column(method, name, method=method) for method in scores.methods]


def _measured(
    scores: Scores, dataset: str, columns: Sequence[Column], title: str, note: str = INTERVAL_NOTE
) -> list[Table]:
    rows = SequenceRows.find(scores, dataset, columns)
    return [rows.render(title, note=note)] if rows.measured else []


def _printed_table(sequences: Sequence[str]) -> list[Table]:
    shown = [name for name in sequences if name in SEQUENCES]
    rows = [(name, *(f"{values[SEQUENCES.index(name)]:.2f}" for values in PRINTED.values())) for name in shown]
    if set(shown) == set(SEQUENCES):
        rows.append(("mean", *(f"{PRINTED_MEAN[method]:.2f}" for method in PRINTED)))
        rows.append(("median", *(f"{PRINTED_MEDIAN[method]:.2f}" for method in PRINTED)))
    note = (
        "Table 1 of the paper, from its own videos of its own objects; ours share their names and kinds. The paper's "
        "code was not run on our videos, so the numbers are context, not a comparison."
    )
    title = "Foreground IoU printed in the paper, measured on other data"
    return [Table(title, ("sequence", *PRINTED), tuple(rows), note)] if shown else []
