"""Exact: the tables of a benchmark from a handful of figures; what the paper prints."""

import numpy as np
import pytest

from threedfs.evaluate.experiment_tables import bin_errors, experiment_tables, group_experiments
from threedfs.evaluate.paper_table import PRINTED, PRINTED_MEAN, PRINTED_MEDIAN, SEQUENCES
from threedfs.evaluate.scores import Failure, Metric, Scores
from threedfs.evaluate.table import Table, render_markdown
from threedfs.evaluate.tables import (
    cost_tables,
    depth_tables,
    mesh_tables,
    overlap_tables,
    pose_tables,
    unseen_tables,
)
from threedfs.evaluate.variant_tables import variant_tables

STATIC = Failure("books", "poses", "", "the camera hardly moves.")


def scores(rows, datasets=None, methods=("fused_sdf",), failures=()):
    """Make scores from {(sequence, method, name): value}."""
    metrics = tuple(Metric(name, value, "1", "", sequence, method) for (sequence, method, name), value in rows.items())
    datasets = datasets or dict.fromkeys((row.sequence for row in metrics), "toys")
    return Scores(metrics, datasets, methods, tuple(failures))


def cells(table):
    """Return a table's cells by row and column title."""
    return {(row[0], title): cell for row in table.rows for title, cell in zip(table.header[1:], row[1:], strict=True)}


def test_overlap_has_a_row_for_each_sequence_and_a_column_for_each_method():
    values = {("mug", "fused_sdf"): 0.9, ("mug", "gc_2d"): 0.8, ("can", "fused_sdf"): 0.6, ("can", "gc_2d"): 0.7}
    rows = {(*key, "iou_mean"): value for key, value in values.items()}
    (table,) = overlap_tables(scores(rows, methods=("fused_sdf", "gc_2d")), "toys")
    assert table.header == ("sequence", "fused_sdf", "gc_2d")
    found = cells(table)
    assert found["mug", "gc_2d"] == "0.800" and found["can", "fused_sdf"] == "0.600"
    # two values: the ends of the interval are the values
    assert found["mean", "fused_sdf"] == "0.750 [0.600, 0.900]"
    assert found["median", "gc_2d"] == "0.750"


def test_a_failed_sequence_tells_why_and_stays_out_of_the_mean():
    rows = {(name, method, "iou_mean"): 0.5 for name in ("mug", "can") for method in ("fused_sdf", "gc_2d")}
    del rows["can", "gc_2d", "iou_mean"]
    late = Failure("can", "object", "gc_2d", "nothing there.")
    datasets = {"mug": "toys", "books": "toys", "can": "toys", "box": "toys", "lamp": "others"}
    table, _ = overlap_tables(scores(rows, datasets, ("fused_sdf", "gc_2d"), [STATIC, late]), "toys")
    found = cells(table)
    assert found["books", "fused_sdf"] == "failed: poses: the camera hardly moves."
    assert found["books", "gc_2d"] == "failed"
    assert found["can", "fused_sdf"] == "0.500" and found["can", "gc_2d"] == "failed: object: nothing there."
    assert found["box", "fused_sdf"] == "not finished"
    assert found["mean", "fused_sdf"] == "0.500 [0.500, 0.500]" and found["mean", "gc_2d"] == "0.500"
    assert table.note.startswith("2 of 4 sequences failed.")
    assert not any(row[0] == "lamp" for row in table.rows)


def test_variants_are_compared_with_their_method_over_the_sequences_of_both():
    values = {("mug", "cut"): 0.9, ("can", "cut"): 0.8, ("mug", "cut@off"): 0.85, ("can", "cut@off"): 0.82}
    values |= {("mug", "cut@late"): 0.8, ("mug", "other"): 0.5}
    rows = {(*key, "iou_mean"): value for key, value in values.items()}
    late = Failure("can", "segment", "joint@late", "nothing open.")
    (table,) = variant_tables(scores(rows, methods=("cut", "other"), failures=[late]), "toys")
    assert "variants of cut, toys" in table.title
    found = cells(table)
    assert found["as configured", "IoU mean"] == "0.850" and found["off", "IoU mean"] == "0.835"
    assert found["off", "change"] == "-0.015 [-0.050, +0.020]"
    assert found["off", "worst"] == "-0.050 mug" and found["off", "best"] == "+0.020 can"
    assert found["off", "lower on"] == "1" and found["off", "sequences"] == "2 of 2"
    assert found["late", "IoU mean"] == "0.800" and found["late", "sequences"] == "1 of 2"
    assert "can joint@late failed: segment: nothing open." in table.note
    assert variant_tables(scores(rows, methods=("other",)), "toys") == []
    overlap = overlap_tables(scores(rows, methods=("cut", "other"), failures=[late]), "toys")[0]
    assert cells(overlap)["can", "cut"] == "0.800"  # a variant that failed is no fault of its method


def test_overlap_names_the_failed_even_where_nothing_was_measured():
    table, _ = overlap_tables(scores({}, {"books": "toys"}, failures=[STATIC]), "toys")
    assert cells(table)["books", "fused_sdf"] == str(STATIC)
    assert overlap_tables(scores({}, {"mug": "toys"}), "toys") == []


def test_printed_numbers_stand_beside_sequences_of_the_same_name_only():
    rows = {("dragon", "fused_sdf", "iou_mean"): 0.95, ("mug", "fused_sdf", "iou_mean"): 0.9}
    _, printed = overlap_tables(scores(rows), "toys")
    assert "printed in the paper, measured on other data" in printed.title
    assert [row[0] for row in printed.rows] == ["dragon"]
    assert cells(printed)["dragon", "SDF + 2D-3D Voxel"] == "0.90"
    (_,) = overlap_tables(scores({("mug", "fused_sdf", "iou_mean"): 0.9}), "toys")
    _, printed = overlap_tables(scores({(name, "fused_sdf", "iou_mean"): 0.9 for name in SEQUENCES}), "toys")
    assert [row[0] for row in printed.rows] == [*SEQUENCES, "mean", "median"]
    assert cells(printed)["mean", "Fused SDF"] == "0.80"


@pytest.mark.parametrize("method", PRINTED)
def test_printed_means_and_medians_are_those_of_the_printed_numbers(method):
    # all are rounded to two digits
    assert len(PRINTED[method]) == len(SEQUENCES)
    assert PRINTED_MEAN[method] == pytest.approx(np.mean(PRINTED[method]), abs=0.0101)
    assert PRINTED_MEDIAN[method] == pytest.approx(np.median(PRINTED[method]), abs=0.0101)


def test_tables_that_have_no_figure_are_left_out():
    empty = scores({("mug", "", "frames_posed"): 1.0})
    for make in (overlap_tables, unseen_tables, pose_tables, mesh_tables, depth_tables, experiment_tables):
        assert make(empty, "toys") == []
    assert cost_tables(empty, "toys", ()) == []


def test_figures_of_all_kinds_come_where_they_belong():
    rows = {
        ("mug", "fused_sdf", "iou_unseen_mean"): 0.7,
        ("mug", "", "pose_centre_error_median"): 0.25,
        ("mug", "", "pose_rotation_error_median"): 0.125,
        ("mug", "fused_sdf", "mesh_accuracy"): 0.5,
        ("mug", "fused_sdf", "mesh_completeness"): 0.6,
        ("mug", "fused_sdf", "mesh_chamfer"): 0.55,
        ("mug", "fused_sdf", "mesh_f_score_0.5"): 0.61,
        ("mug", "fused_sdf", "mesh_f_score_1"): 0.81,
        ("mug", "fused_sdf", "mesh_far_share"): 3.25,
        ("mug", "fused_sdf", "mesh_normal_error"): 12.5,
        ("mug", "fused_sdf", "mesh_closed"): 1.0,
        ("mug", "fused_sdf", "mesh_genus"): 2.0,
        ("mug", "fused_sdf", "mesh_pieces"): 1.0,
        ("mug", "fused_sdf", "mesh_filled"): 0.52,
        ("mug", "fused_sdf", "photo_psnr"): 27.75,
        ("mug", "fused_sdf", "photo_ssim"): 0.875,
        ("mug", "", "depth_rmse"): 0.0123,
        ("mug", "", "depth_within_10"): 99.0,
    }
    made = scores(rows)
    assert cells(unseen_tables(made, "toys")[0])["mug", "fused_sdf"] == "0.700"
    poses = cells(pose_tables(made, "toys")[0])
    assert poses["mug", "centre, median, % of path"] == "0.250"
    assert poses["mug", "rotation, median, degrees"] == "0.125" and poses["mug", "rotation, largest"] == "-"
    (mesh,) = mesh_tables(made, "toys")
    measured = cells(mesh)
    assert [measured["mug", f"F-score at {t} %"] for t in ("0.5", "1")] == ["0.610", "0.810"]
    assert mesh.rows[0][1:4] == ("0.500", "0.600", "0.550")
    assert mesh.rows[0][-8:] == ("3.2", "12.5", "1", "1", "2", "0.52", "27.8", "0.875")
    sound = ("closed", "pieces", "handles", "filled")
    assert mesh.header[-8:] == ("farther than 2 %, %", "normals, degrees", *sound, "photographs, PSNR, dB", "SSIM")
    depth = cells(depth_tables(made, "toys")[0])
    assert depth["mug", "within 10 %"] == "99.0" and depth["mug", "RMSE, unit of the truth"] == "0.0123"


def test_costs_have_columns_in_the_order_of_the_stages_and_count_the_failed():
    rows = {
        ("mug", "", "seconds_zoom"): 1.0,
        ("mug", "", "seconds_depth"): 3.0,
        ("mug", "", "seconds_poses"): 2.0,
        ("mug", "", "seconds"): 6.0,
        ("books", "", "seconds_poses"): 4.0,
        ("books", "", "seconds"): 4.0,
        ("mug", "", "peak_memory_depth"): 300.0,
        ("mug", "", "bytes_depth"): 2.5e6,
    }
    seconds, memory, size = cost_tables(scores(rows, failures=[STATIC]), "toys", ("poses", "depth"))
    assert seconds.header == ("sequence", "poses", "depth", "zoom", "all stages")
    assert seconds.rows[1] == ("books", "4.0", "-", "-", "4.0")
    assert seconds.rows[2][1] == "3.0 [2.0, 4.0]" and seconds.rows[3] == ("total", "6.0", "3.0", "1.0", "10.0")
    assert cells(memory)["largest", "depth"] == "300" and cells(size)["mug", "depth"] == "2.5"


def experiment():
    rows = {}
    for name, error in (("mug", 0.1), ("can", 0.3)):
        for count in (1000, 100):
            for prior, factor in (("first_order", 1.0), ("interpolation", 2.0)):
                method = f"depth/{prior}/{count}"
                rows[name, method, "depth_rmse"] = factor * error
                rows[name, method, "depth_rmse_bin_0.5_1"] = factor * error
                rows[name, method, "depth_pixels_bin_0.5_1"] = 300.0 if name == "mug" else 100.0
    rows["mug", "depth/first_order/100", "depth_rmse_bin_10_11"] = 1.0
    rows["mug", "depth/first_order/100", "depth_pixels_bin_10_11"] = 7.0
    rows["lamp", "fused_sdf", "iou_mean"] = 0.9
    return scores(rows, failures=[STATIC], datasets=dict.fromkeys(("mug", "can", "lamp", "books"), "toys"))


def test_experiment_is_grouped_by_count_and_prior():
    made = experiment()
    groups = group_experiments(made)
    assert list(groups) == [100, 1000] and list(groups[100]) == ["first order", "interpolation"]
    by_sequence, means, *others = experiment_tables(made, "toys")
    assert len(others) == 2
    assert [row[0] for row in by_sequence.rows] == ["mug", "can", "books", "mean", "median"]
    assert cells(by_sequence)["can", "interpolation"] == "0.6000"
    assert cells(means)["first order", "RMSE, unit of the truth"] == "0.2000 [0.1000, 0.3000]"


def test_binned_errors_are_pooled_over_pixels():
    depth, rmse = bin_errors(experiment(), "toys", "depth", "depth/first_order/100")
    np.testing.assert_allclose(depth, [0.75, 10.5])
    np.testing.assert_allclose(rmse, [np.sqrt((300 * 0.1**2 + 100 * 0.3**2) / 400), 1.0])
    assert len(bin_errors(experiment(), "toys", "object_depth", "depth/first_order/100")[0]) == 0


def test_markdown_keeps_a_sentence_in_its_cell():
    text = render_markdown(Table("T", ("a", "b"), (("x", "one | two\nthree"),)))
    assert text.splitlines()[-1] == "| x   | one \\| two three |"
