"""Contract: what a run leaves behind when some of its sequences fail."""

from __future__ import annotations

import csv

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
    assert {row.sequence for row in read_metrics(broken.folder / "results/tables/metrics.csv")} == {"mug"}
    assert "| static   |" in read(broken, "benchmarks/costs.md")
    assert "iou_toys.svg" in {path.name for path in (broken.folder / "results/plots").iterdir()}
    assert not (broken.folder / "results/metrics.csv").exists()
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
    assert not (finished.folder / "results/metrics.csv").exists()
    assert "threedfs: poses of sample: ValueError" in output


def test_a_failed_run_that_was_to_collect_nothing_leaves_tables_alone(finished):
    before = read(finished, "tables/iou.md")
    finished.edit("src/threedfs/stages/poses.py", "    write(", "    raise ValueError('no such thing')\n    write(")
    finished.run("results/sample/02_poses/poses.json", good=False)
    assert read(finished, "tables/iou.md") == before
    assert (finished.folder / "results/metrics.csv").is_file()


def test_tables_of_sets_that_are_gone_are_gone(finished):
    assert (finished.folder / "results/plots/iou_sample.svg").is_file()
    (finished.folder / "own.yaml").write_text("dataset: own\n")
    finished.run("--configfile", "own.yaml")
    assert [path.name for path in (finished.folder / "results/plots").iterdir()] == ["iou_own.svg"]
