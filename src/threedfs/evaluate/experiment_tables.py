"""The tables of the depth experiment: priors and interpolation, by number of measurements, given the poses.

Its rows in the table of metrics have methods `depth/PRIOR/COUNT`, and figures of three regions, whole and by depth.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from threedfs.evaluate.scores import Scores
from threedfs.evaluate.sequence_rows import INTERVAL_NOTE, Column, SequenceRows, format_mean, pick
from threedfs.evaluate.table import Table

REGIONS = {
    "depth": "all pixels with a true depth",
    "object_depth": "pixels of the object",
    "object_range_depth": "all pixels at depths of the object",
}
"""Where depth is measured: how the names of figures begin, and what that stands for."""


def experiment_tables(scores: Scores, dataset: str) -> list[Table]:
    """Return the RMSE, sequences x priors, and the means of all figures, priors x figures; for each count and region.

    References
    ----------
    Section 4.2.
    """
    tables = []
    for region, where in REGIONS.items():
        for count, priors in group_experiments(scores).items():
            columns = [Column(prior, f"{region}_rmse", ".4f", method) for prior, method in priors.items()]
            rows = SequenceRows.find(scores, dataset, columns)
            shown = {name: row for name, row in rows.values.items() if pick(row) or scores.excuse(name, "depth")}
            if rows.measured:
                what = f"{count} measurements, {where}, {dataset}"
                rows = SequenceRows(scores, rows.columns, shown)
                tables.append(rows.render(f"RMSE of depth, unit of the truth: {what}", ("mean", "median")))
                tables.append(_means(scores, dataset, region, priors, f"Depth, means over sequences: {what}"))
    return tables


def bin_errors(scores: Scores, dataset: str, region: str, method: str) -> tuple[np.ndarray, np.ndarray]:
    """Pool the binned errors of a data set's sequences.

    Returns
    -------
    depth, rmse : (B,) float64
        Centres of the bins in ascending order, and the root of the mean squared error over all pixels of all sequences.
    """
    pattern = re.compile(rf"{region}_rmse_bin_([0-9.e+-]+)_([0-9.e+-]+)")
    bins = sorted(
        (float(match[1]), float(match[2]), name) for name in scores.names if (match := pattern.fullmatch(name))
    )
    centres, errors = [], []
    for low, high, name in bins:
        pairs = [
            (
                scores.value(sequence, method, name.replace("_rmse_", "_pixels_", 1)),
                scores.value(sequence, method, name),
            )
            for sequence in scores.sequences(dataset)
        ]
        pixels, rmse = np.array([pair for pair in pairs if None not in pair], np.float64).reshape(-1, 2).T
        if pixels.sum() > 0:
            centres.append((low + high) / 2)
            errors.append(float(np.sqrt((pixels * rmse**2).sum() / pixels.sum())))
    return np.array(centres), np.array(errors)


def group_experiments(scores: Scores) -> dict[int, dict[str, str]]:
    """Return the methods of the experiment: for each number of measurements, fewest first, by prior."""
    groups: dict[int, dict[str, str]] = {}
    for method in dict.fromkeys(row.method for row in scores.metrics):
        if match := re.fullmatch(r"depth/([a-z_]+)/(\d+)", method):
            groups.setdefault(int(match[2]), {})[match[1].replace("_", " ")] = method
    return dict(sorted(groups.items()))


def _means(scores: Scores, dataset: str, region: str, priors: Mapping[str, str], title: str) -> Table:
    columns = (
        Column("RMSE, unit of the truth", f"{region}_rmse", ".4f"),
        Column("relative error, median, %", f"{region}_error_median", ".2f"),
        Column("mean", f"{region}_error_mean", ".2f"),
        Column("pixels within 1 %, %", f"{region}_within_1", ".1f"),
        Column("within 10 %", f"{region}_within_10", ".1f"),
    )
    rows = []
    for prior, method in priors.items():
        found = [
            pick(scores.value(sequence, method, column.name) for sequence in scores.sequences(dataset))
            for column in columns
        ]
        means = (format_mean(values, column.form, scores.seed) for values, column in zip(found, columns, strict=True))
        rows.append((prior, *means))
    return Table(title, ("prior", *(column.title for column in columns)), tuple(rows), INTERVAL_NOTE)
