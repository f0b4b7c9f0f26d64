"""The tables printed at the end of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

OBJECT_COLUMNS = (
    ("IoU mean", "iou_mean", ".3f"),
    ("median", "iou_median", ".3f"),
    ("min", "iou_min", ".3f"),
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
"""Title, name of the figure and format of each column, for reconstructed objects."""

DEPTH_COLUMNS = (
    ("RMSE", "depth_rmse", ".4f"),
    ("relative error %", "depth_mean_relative_error", ".2f"),
    ("within 1 %", "depth_within_1", ".1f"),
    ("within 10 %", "depth_within_10", ".1f"),
    ("RMSE at object depths", "depth_rmse_at_object_depths", ".4f"),
)
"""The same for the depth experiment."""


def render_summary(
    tables: Mapping[str, Mapping[str, float]], columns: Sequence[tuple[str, str, str]] = OBJECT_COLUMNS
) -> str:
    """Return one line for each sequence and method, with the figures that at least one of them has.

    Parameters
    ----------
    tables : mapping of str to mapping of str to float
        For each label of a line (sequence and method), the figures of the whole sequence by name.
    columns : sequence of (str, str, str)

    Examples
    --------
    >>> print(render_summary({"can": {"iou_mean": 0.93}, "toy rabbit": {}}))
                IoU mean
    can            0.930
    toy rabbit         -
    """
    columns = [column for column in columns if any(column[1] in figures for figures in tables.values())]
    rows = [["", *(title for title, _, _ in columns)]]
    for label, figures in tables.items():
        rows.append([label, *(format(figures[name], form) if name in figures else "-" for _, name, form in columns)])
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
