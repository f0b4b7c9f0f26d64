"""Exact and property: plots show what they are given, in the same bytes."""

import re
import subprocess
import sys
from xml.etree import ElementTree

from threedfs.evaluate.plots import plot_depth_experiment, plot_overlap
from threedfs.evaluate.scores import Metric, Scores

ROWS = (
    Metric("iou_mean", 0.5, "1", "toys", "mug", "fused_sdf"),
    Metric("iou_mean", 0.25, "1", "toys", "can", "fused_sdf"),
    Metric("depth_rmse_bin_0.5_1", 0.1, "m", "toys", "mug", "depth/first_order/100"),
    Metric("depth_pixels_bin_0.5_1", 9, "px", "toys", "mug", "depth/first_order/100"),
    Metric("depth_rmse_bin_1_1.5", 0.2, "m", "toys", "mug", "depth/first_order/100"),
    Metric("depth_pixels_bin_1_1.5", 9, "px", "toys", "mug", "depth/first_order/100"),
)
SCORES = Scores(ROWS, dict.fromkeys(("mug", "can", "box"), "toys"), ("fused_sdf",))


def test_bars_are_as_high_as_the_overlap():
    text = plot_overlap(SCORES, "toys")
    ElementTree.fromstring(text)
    bars = [
        [float(number) for number in re.findall(r"[ML] \S+ (\S+)", path)]
        for path in re.findall(r'<path d="([^"]+)"[^>]*style="fill: #0072b2"', text)
    ]
    heights = [max(bar) - min(bar) for bar in bars if len(bar) == 4]
    assert abs(heights[0] - 2 * heights[1]) < 1e-4
    assert all(f"<!-- {name} -->" in text for name in ("mug", "can", "box", "none", "fused_sdf"))


def test_lines_of_the_experiment_have_a_name_and_a_unit():
    text = plot_depth_experiment(SCORES, "toys", 100)
    assert all(f"<!-- {name} -->" in text for name in ("first order", "true depth, m", "RMSE, m"))
    assert "pixels of the object" not in text


def test_nothing_is_drawn_of_nothing():
    assert plot_depth_experiment(SCORES, "toys", 1000) is None
    assert plot_overlap(Scores((), {"mug": "toys"}, ("fused_sdf",)), "toys") is None


def test_another_process_draws_the_same_bytes():
    code = (
        "from threedfs.evaluate.plots import *\nfrom threedfs.evaluate.scores import Metric\n"
        f"print(plot_overlap({SCORES!r}, 'toys') + plot_depth_experiment({SCORES!r}, 'toys', 100), end='')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == plot_overlap(SCORES, "toys") + plot_depth_experiment(SCORES, "toys", 100)
