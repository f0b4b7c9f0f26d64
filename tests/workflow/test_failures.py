"""Contract: what a run leaves behind when some of its sequences fail."""

from __future__ import annotations

import csv
import io
import json
import shutil

import pytest

from threedfs.io.metrics import read_metrics

STATIC = "static: the camera hardly moves."


@pytest.fixture
def broken(project):
    """A project of three sequences: a sound one, one with a camera that does not move, one without a file."""
    for name in ("mug", "static"):
        (project.folder / f"{name}.mp4").write_text(name)
    entries = "mug: {source: mug.mp4}, static: {source: static.mp4, dataset: odd}, lost: {source: lost.mp4}"
    (project.folder / "three.yaml").write_text(f"dataset: toys\nsequences: {{{entries}}}\n")
    project.edit(
        "src/threedfs/stages/poses.py",
        "    write(",
        f"    if 'static' in str(frames):\n        from threedfs.errors import UserError\n"
        f"        raise UserError('{STATIC}')\n    write(",
    )
    return project


def read(project, path):
    """Read a file of the results."""
    return (project.folder / "results" / path).read_text()


def test_others_are_finished_and_the_tables_name_the_failed(broken):
    output = broken.run("--configfile", "three.yaml", "--keep-going", good=False)
    table = read(broken, "tables/iou.md")
    assert "failed: frames: sequences.lost.source: expected a file or folder, found no lost.mp4" in table
    assert f"failed: poses: {STATIC}" in table.partition("### Foreground IoU over keyframes, odd")[2]
    assert "| mug      |" in table and "0.500" in table
    assert {row.sequence for row in read_metrics(broken.folder / "results/metrics.csv")} == {"mug"}
    assert "| static   |" in read(broken, "benchmarks/costs.md")
    assert "iou_toys.svg" in {path.name for path in (broken.folder / "results/plots").iterdir()}
    assert not (broken.folder / "results/tables/metrics.csv").exists()
    page = read(broken, "index.html")
    assert page.index(">mug<") < page.index(">static<") < page.index(">lost<") and STATIC in page
    assert page.count("<tr ") == 3 and 'href="mug/report.html"' in page
    end = output[output.index("mug fused_sdf") :].splitlines()
    assert f"threedfs: poses of static: {STATIC}" in end
    assert any(line.startswith("threedfs: frames of lost: sequences.lost.source: expected") for line in end)
    assert any(line.split() == ["toys", "fused_sdf", "0.500", "0.500", "1", "of", "2"] for line in end)

    # put right, the run is completed
    (broken.folder / "lost.mp4").write_text("found")
    broken.edit("src/threedfs/stages/poses.py", "if 'static'", "if 'statisch'")
    broken.run("--configfile", "three.yaml")
    assert "failed" not in read(broken, "tables/iou.md")
    with open(broken.folder / "results/metrics.csv") as file:
        measured = [(row["sequence"], row["method"]) for row in csv.DictReader(file)]
    assert measured == [(name, method) for method in ("", "fused_sdf") for name in ("mug", "static", "lost")]
    assert "Nothing to be done" in broken.run("--configfile", "three.yaml")


def test_missing_file_without_keep_going_stops_the_run_at_once(broken):
    output = broken.run("--configfile", "three.yaml", good=False)
    assert "threedfs: sequences.lost.source: expected a file or folder, found no lost.mp4" in output
    assert not (broken.folder / "results/mug").exists()


def test_figures_of_an_earlier_run_are_not_shown_for_a_sequence_that_fails_now(finished):
    assert "0.500" in read(finished, "tables/iou.md")
    finished.edit(
        "src/threedfs/stages/poses.py",
        "    write(",
        "    raise ValueError('no such thing')\n    write(",
    )
    output = finished.run(good=False)
    table = read(finished, "tables/iou.md")
    assert "failed: poses: ValueError: no such thing (see results/sample/logs/poses.log)" in table
    assert "0.500" not in table
    assert read_metrics(finished.folder / "results/metrics.csv") == []
    assert not list((finished.folder / "results/sample/12_evaluate").rglob("*.csv"))
    assert "iou_mean" not in read(finished, "sample/report.html")
    assert "threedfs: poses of sample: ValueError" in output


def test_a_failed_run_that_was_to_collect_nothing_leaves_tables_alone(finished):
    before = read(finished, "tables/iou.md")
    finished.edit("src/threedfs/stages/poses.py", "    write(", "    raise ValueError('no such thing')\n    write(")
    finished.run("results/sample/02_poses/poses.json", good=False)
    assert read(finished, "tables/iou.md") == before
    assert (finished.folder / "results/metrics.csv").is_file()


def test_tables_keep_the_sequences_of_earlier_runs(finished):
    """Contract: another sequence, also one that fails, takes nothing away; its own failure names it alone."""
    before = read(finished, "metrics.csv").splitlines()
    (finished.folder / "mug.mp4").write_text("mug")
    order = ("--config", "video=mug.mp4", "dataset=toys")
    output = finished.run(*order)
    rows = read_metrics(finished.folder / "results/metrics.csv")
    assert list(dict.fromkeys(row.sequence for row in rows)) == ["mug", "sample"]
    assert set(before) < set(read(finished, "metrics.csv").splitlines())
    table = read(finished, "tables/iou.md")
    assert table.index("toys\n") < table.index("| mug ") < table.index("sample\n") < table.index("| sample ")
    assert "| sample " in read(finished, "benchmarks/costs.md")
    assert {path.name for path in (finished.folder / "results/plots").iterdir()} == {"iou_toys.svg", "iou_sample.svg"}
    assert "sample fused_sdf" not in output  # what a run says is of its own sequences
    page = read(finished, "index.html")
    assert page.index(">mug<") < page.index(">sample<") and page.count("0.500") == 2
    (finished.folder / "cup.mp4").write_text("cup")
    finished.edit("src/threedfs/stages/poses.py", "    write(", "    raise ValueError('no such thing')\n    write(")
    finished.run("--config", "video=cup.mp4", good=False)
    assert set(read(finished, "metrics.csv").splitlines()) == {*before, *(r for r in csv_rows(rows))}
    assert read(finished, "tables/iou.md").count("failed: poses") == 1
    shutil.rmtree(finished.folder / "results/mug")
    finished.run("--config", "video=cup.mp4", good=False)
    assert {row.sequence for row in read_metrics(finished.folder / "results/metrics.csv")} == {"sample"}


def csv_rows(rows):
    """Return rows as lines of the table."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(
        [row.name, f"{row.value:.9g}", row.unit, row.dataset, row.sequence, row.method, row.keyframe] for row in rows
    )
    return text.getvalue().splitlines()


def test_a_damaged_table_of_another_sequence_is_left_out(finished):
    shutil.copytree(finished.folder / "results/sample", finished.folder / "results/old")
    (finished.folder / "results/old/12_evaluate/fused_sdf/metrics.csv").write_text("of another version\n")
    (finished.folder / "own.yaml").write_text("dataset: own\n")
    finished.run("--configfile", "own.yaml")
    assert {row.sequence for row in read_metrics(finished.folder / "results/metrics.csv")} == {"sample"}


def test_a_method_taken_out_is_not_listed_and_its_results_stay(finished):
    (finished.folder / "two.yaml").write_text("methods: [fused_sdf, tsdf]\n")
    finished.run("--configfile", "two.yaml")
    assert "tsdf" in read(finished, "tables/iou.md") and "tsdf" in read(finished, "metrics.csv")
    finished.run()
    assert "tsdf" not in read(finished, "tables/iou.md") and "tsdf" not in read(finished, "metrics.csv")
    assert json.loads(read(finished, "sample/report.json"))["methods"] == ["fused_sdf"]
    assert (finished.folder / "results/sample/11_object/tsdf/mesh.ply").is_file()


def test_a_texture_of_the_mesh_before_is_gone_when_the_mesh_alone_is_made_anew(finished):
    order = ("results/sample/11_object/surface/mesh.glb", "--configfile", "surface.yaml")
    (finished.folder / "surface.yaml").write_text("methods: [surface]\n")
    finished.run(*order)
    made = finished.folder / "results/sample/11_object/surface"
    assert (made / "textured").is_dir() and (made / "mesh.glb").is_file()
    (finished.folder / "surface.yaml").write_text("methods: [surface]\nsurface: {frames: 7}\n")
    finished.run("results/sample/11_object/surface/mesh.ply", *order[1:])
    assert (made / "mesh.ply").is_file() and not (made / "textured").exists() and not (made / "mesh.glb").exists()
    finished.run(*order)
    assert (made / "textured").is_dir() and (made / "mesh.glb").is_file()


def test_tables_of_sets_that_are_gone_are_gone(finished):
    assert (finished.folder / "results/plots/iou_sample.svg").is_file()
    (finished.folder / "own.yaml").write_text("dataset: own\n")
    finished.run("--configfile", "own.yaml")
    assert [path.name for path in (finished.folder / "results/plots").iterdir()] == ["iou_own.svg"]


@pytest.mark.parametrize("before", ['    write_metrics(run.results / "metrics.csv"', "    write_index_page("])
def test_a_run_killed_while_it_writes_its_tables_and_pages_is_completed(finished, before):
    right = finished.artifacts()
    shutil.rmtree(finished.folder / "results")
    death = "    import os, signal\n    os.kill(os.getpid(), signal.SIGKILL)\n"
    finished.edit("src/threedfs/run_end/finish.py", before, death + before)
    finished.run(good=False)
    assert not (finished.folder / "results/index.html").exists()
    finished.edit("src/threedfs/run_end/finish.py", death, "")
    finished.run()
    assert finished.artifacts() == right
    assert "Nothing to be done" in finished.run()
