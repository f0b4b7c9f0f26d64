"""What a finer video brings, and what it costs: takes rendered at several widths.

    python benchmarks/resolution.py results/dragon_640 results/dragon_1280 ... [--plot docs/pictures/resolution.svg]

Takes the results of rendered sequences that are named TAKE_WIDTH and were run one at a time, from a configuration as

    dataset: resolution
    methods: [surface]
    keyframes_at_truth: true
    render: {mask_step: 6}
    keyframes: {max_keyframes: 20}
    sequences:
      dragon_640: {rendered: dragon, settings: {render: {width: 640}}}

Prints the scores of `surface` and the summed wall time of all jobs but the rendering, seconds.
"""

from __future__ import annotations

import argparse
import csv
from collections import defaultdict
from pathlib import Path

from matplotlib import rc_context
from matplotlib.figure import Figure

from threedfs.evaluate.plots import COLOURS
from threedfs.io.metrics import read_metrics

NAMES = ("mesh_f_score_0.25", "mesh_f_score_0.5", "mesh_f_score_1", "iou_mean", "iou_unseen_mean")


def read_seconds(results: Path) -> float:
    """Sum the wall times of a sequence's jobs, as Snakemake measured them, without the rendering."""
    total = 0.0
    for path in sorted(results.glob("**/benchmarks/**/*.tsv")):
        if path.name != "render.tsv":
            with path.open(encoding="utf-8", newline="") as lines:
                total += sum(float(row["s"]) for row in csv.DictReader(lines, delimiter="\t"))
    return total


def read_scores(results: Path) -> dict[str, float]:
    """Read the scores of the method surface."""
    metrics = read_metrics(results / "12_evaluate" / "surface" / "metrics.csv")
    return {metric.name: metric.value for metric in metrics if metric.name in NAMES and not metric.keyframe}


def draw_curves(measured: dict[str, dict[int, tuple[dict[str, float], float]]], path: Path) -> None:
    """Draw F-scores and seconds over the width of the video, a line for each take."""
    figure = Figure(figsize=(7.2, 3.2), layout="constrained")
    scores, seconds = figure.subplots(1, 2)
    for number, (take, by_width) in enumerate(measured.items()):
        widths = sorted(by_width)
        colour = COLOURS[number % len(COLOURS)]
        scores.plot(widths, [by_width[w][0]["mesh_f_score_0.5"] for w in widths], "o-", color=colour, label=take)
        seconds.plot(widths, [by_width[w][1] for w in widths], "o-", color=colour, label=take)
    every = sorted({width for by_width in measured.values() for width in by_width})
    scores.set_ylabel("F-score at 0.5 %")
    seconds.set_ylabel("seconds of jobs")
    seconds.set_ylim(bottom=0)
    for axes in (scores, seconds):
        axes.set_xscale("log", base=2)
        axes.set_xticks(every, [str(width) for width in every])
        axes.set_xlabel("width of the video, px")
    scores.legend(fontsize=8, frameon=False)
    with rc_context({"svg.hashsalt": "threedfs"}):
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None})


def main() -> None:
    """Print a line for each sequence."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("results", type=Path, nargs="+", help="folders of the results of sequences TAKE_WIDTH")
    parser.add_argument("--plot", type=Path, help="draw the curves into this SVG")
    options = parser.parse_args()
    measured: dict[str, dict[int, tuple[dict[str, float], float]]] = defaultdict(dict)
    print(f"{'sequence':>16} {'seconds':>8}", *(f"{name:>18}" for name in NAMES))
    for results in options.results:
        take, _, width = results.name.rpartition("_")
        scores, seconds = read_scores(results), read_seconds(results)
        measured[take][int(width)] = scores, seconds
        print(f"{results.name:>16} {seconds:8.0f}", *(f"{scores[name]:18.3f}" for name in NAMES))
    if options.plot is not None:
        draw_curves(measured, options.plot)


if __name__ == "__main__":
    main()
