"""Exact, property and rejection: the table of metrics on disk, the printed summary, costs."""

import numpy as np
import pytest

from threedfs.errors import UserError
from threedfs.evaluate.costs import cost_figures
from threedfs.evaluate.depth_error import DepthPairs
from threedfs.evaluate.figures import depth_figures, mask_figures
from threedfs.evaluate.scores import Metric
from threedfs.evaluate.summary import render_summary
from threedfs.io.metrics import COLUMNS, read_metrics, write_metrics


def test_a_table_survives_the_round_trip(tmp_path):
    rows = [
        Metric("iou", 0.912345678, "1", "real", "mug", "fused_sdf", "000010"),
        Metric("mesh_accuracy", 1e-12, "% of diagonal", "real", 'a "quoted", name'),
        Metric("depth_rmse", float("nan"), "m"),
    ]
    write_metrics(tmp_path / "metrics.csv", rows)
    found = read_metrics(tmp_path / "metrics.csv")
    assert found[:2] == rows[:2] and str(found[2].value) == "nan"
    header = (tmp_path / "metrics.csv").read_text().splitlines()[0]
    assert header == "name,value,unit,dataset,sequence,method,keyframe" == ",".join(COLUMNS)


def test_values_that_differ_past_nine_digits_have_equal_bytes(tmp_path):
    for name, value in (("a", 1 / 3), ("b", 1 / 3 + 1e-14)):
        write_metrics(tmp_path / name, [Metric("iou", value, "1")])
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_refuses_tables_that_are_none(tmp_path):
    path = tmp_path / "metrics.csv"
    with pytest.raises(UserError, match="found none; rule evaluate writes it"):
        read_metrics(path)
    path.write_text("name,value\n")
    with pytest.raises(UserError, match="expected the columns name,value,unit"):
        read_metrics(path)
    for row in ("iou,high,1,,,,", "iou,0.5"):
        path.write_text(",".join(COLUMNS) + "\n" + row + "\n")
        with pytest.raises(UserError, match="a number as value in line 2"):
            read_metrics(path)


def test_mean_median_and_least_overlap():
    overlap = mask_figures({"a": 0.9, "b": 0.5, "c": 0.7})
    figures = {figure.name: figure.value for figure in overlap if not figure.keyframe}
    assert figures == {"iou_mean": pytest.approx(0.7), "iou_median": 0.7, "iou_min": 0.5}
    assert mask_figures({}) == []


def test_depth_of_a_sequence_is_over_pixels_not_over_keyframes():
    small = DepthPairs(np.array([1.5]), np.array([1.0]))
    large = DepthPairs(np.ones(9), np.ones(9))
    figures = depth_figures({"a": small, "b": large}, "m")
    assert [(figure.keyframe, figure.value) for figure in figures[:2]] == [("a", 50.0), ("b", 0.0)]
    pooled = {figure.name: figure.value for figure in figures[2:]}
    assert (pooled["depth_error_median"], pooled["depth_error_mean"], pooled["depth_within_1"]) == (0, 5, 90)
    assert depth_figures({}, "m") == []


def test_summary_has_a_line_for_each_sequence_and_only_known_columns():
    lines = render_summary({"mug": {"iou_mean": 0.912, "path_turns": 1.6}, "bunny": {"iou_mean": 0.9}}).splitlines()
    expected = [["IoU", "mean", "turns"], ["mug", "0.912", "1.60"], ["bunny", "0.900", "-"]]
    assert [line.split() for line in lines] == expected
    assert len({len(line) for line in lines}) == 1


def test_costs_add_up_and_memory_does_not():
    jobs = [
        {"stage": "depth", "seconds": 3.0, "peak_memory_mb": 500, "bytes": {"depth": 7}},
        {"stage": "depth", "seconds": 4.0, "peak_memory_mb": 400, "bytes": {"depth": 8}},
        {"stage": "poses", "seconds": 5.0, "peak_memory_mb": 300, "bytes": {"poses": 1, "points": 2}},
    ]
    found = {figure.name: figure.value for figure in cost_figures(jobs)}
    assert found["seconds"] == 12 and found["seconds_depth"] == 7
    assert found["peak_memory_depth"] == 500 and found["bytes_poses"] == 3
    assert cost_figures([]) == []
