"""The plots of a benchmark, as SVG: the same bytes for the same figures."""

from __future__ import annotations

import io
from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from threedfs.evaluate.experiment_tables import REGIONS, bin_errors, group_experiments
from threedfs.evaluate.scores import Scores

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555", "#a6761d")
"""Told apart by people who see few colours (Okabe and Ito)."""


def plot_overlap(scores: Scores, dataset: str) -> str | None:
    """Draw the foreground IoU of every sequence as bars, one for each method; None if there is no figure.

    A sequence without a figure keeps its place.
    """
    sequences = scores.sequences(dataset)
    heights = [[scores.value(sequence, method, "iou_mean") for sequence in sequences] for method in scores.methods]
    known = [value for row in heights for value in row if value is not None]
    if not known:
        return None
    figure, axes = _start((max(4.0, 1.2 + 0.45 * len(sequences) * (1 + 0.25 * len(scores.methods))), 3.4))
    width = 0.8 / len(scores.methods)
    for number, (method, row) in enumerate(zip(scores.methods, heights, strict=True)):
        places = np.arange(len(sequences)) + (number - (len(scores.methods) - 1) / 2) * width
        values = np.array([np.nan if value is None else value for value in row])
        axes[0].bar(places, values, width, color=COLOURS[number % len(COLOURS)], label=method)
        for place in places[np.isnan(values)]:
            axes[0].text(place, 0.01, "none", rotation=90, ha="center", va="bottom", color="#888888", fontsize=7)
    axes[0].set_xticks(np.arange(len(sequences)), sequences, rotation=45, ha="right", rotation_mode="anchor")
    axes[0].set_ylim(0, 1)
    axes[0].set_ylabel("foreground IoU")
    axes[0].set_title(dataset, fontsize=10)
    _tidy(axes[0])
    figure.legend(loc="outside right upper", fontsize=7, frameon=False)
    return _draw(figure)


def plot_depth_experiment(scores: Scores, dataset: str, count: int) -> str | None:
    """Draw the RMSE as a function of true depth, a line for each prior and a panel for each region; None without rows.

    Errors are pooled over the pixels of all sequences.

    References
    ----------
    Section 4.2, the figure labelled fig:plot.
    """
    priors = group_experiments(scores).get(count, {})
    lines = {
        region: {prior: bin_errors(scores, dataset, region, method) for prior, method in priors.items()}
        for region in REGIONS
    }
    drawn = [region for region, found in lines.items() if any(len(depth) for depth, _ in found.values())]
    if not drawn:
        return None
    figure, axes = _start((4.4 * len(drawn), 3.4), len(drawn))
    for panel, region in zip(axes, drawn, strict=True):
        for number, (prior, (depth, rmse)) in enumerate(lines[region].items()):
            style = "--" if prior == "interpolation" else "-"
            panel.plot(depth, rmse, style, marker="o", markersize=3, color=COLOURS[number % len(COLOURS)], label=prior)
        unit = next(row.unit for row in scores.metrics if row.name.startswith(f"{region}_rmse_bin_"))
        panel.set_xlabel(f"true depth, {unit}")
        panel.set_ylabel(f"RMSE, {unit}")
        panel.set_ylim(bottom=0)
        panel.set_title(f"{dataset}, {count} measurements,\n{REGIONS[region]}", fontsize=9)
        _tidy(panel)
        panel.legend(fontsize=7, frameon=False)
    return _draw(figure)


def _start(size: tuple[float, float], panels: int = 1) -> tuple[Figure, Sequence[Axes]]:
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(1, panels, squeeze=False)[0]


def _tidy(axes: Axes) -> None:
    axes.grid(axis="y", linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8)


def _draw(figure: Figure) -> str:
    text = io.StringIO()
    # without these, names of elements are drawn at random and the date is written
    with matplotlib.rc_context({"svg.hashsalt": "threedfs", "svg.fonttype": "path"}):
        FigureCanvasSVG(figure).print_svg(text, metadata={"Date": None, "Creator": None})
    return text.getvalue()
