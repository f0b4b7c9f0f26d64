"""Workflow: what `threedfs clean` removes and keeps, on a copy of the project whose stages are stand-ins."""

from __future__ import annotations

import fcntl
import json
import shutil

import pytest

from threedfs.cli.main import main

WANTED = ("mesh.ply", "masks/000001.png", "poses.json", "support.json", "report.html", "keyframes.json")


@pytest.fixture(scope="module")
def finished_command(first_run, tmp_path_factory):
    """A copy of the project, a folder in which its command has reconstructed a mug, and what that holds."""
    folder, kept = tmp_path_factory.mktemp("mine"), tmp_path_factory.mktemp("kept") / "mine"
    (folder / "mug.mp4").write_text("film")
    status, output = first_run[0].call(folder, "run", "mug.mp4", "--cores", "2")
    assert status == 0, output
    shutil.copytree(folder, kept, symlinks=True)
    return first_run[0], folder, kept


@pytest.fixture
def mine(finished_command, monkeypatch, capsys):
    """The folder as it was, and what calls the command in it; the place of the video counts, so it stays."""
    project, folder, kept = finished_command
    shutil.rmtree(folder)
    shutil.copytree(kept, folder, symlinks=True)
    monkeypatch.chdir(folder)

    def run(*words):
        if words[0] == "run":
            return project.call(folder, *words)
        return main(words), capsys.readouterr().out

    return folder, run


def files_of(folder):
    """Return the files of the sequence with their bytes, without logs, costs and the report, which tell times."""
    own = (path for path in (folder / "results/mug").rglob("*") if path.is_file())
    kept = (path for path in own if not {"logs", "benchmarks", "report.html"} & set(path.parts))
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in kept}


def test_what_can_be_removed_is_listed_first_and_stays(mine):
    folder, run = mine
    before = files_of(folder)
    status, output = run("clean", "mug")
    assert status == 0 and "nothing has been removed yet. Add --yes" in output
    assert f"MB  {folder}/results/mug/06_depth" in output and "11_object" not in output
    assert files_of(folder) == before


@pytest.mark.parametrize("words", [["mug"], ["results/mug"], ["--all"]])
def test_only_what_no_user_wants_is_removed(mine, words):
    folder, run = mine
    before = files_of(folder)
    page = (folder / "results/mug/report.html").read_bytes()
    status, output = run("clean", *words, "--yes")
    assert status == 0 and f"remain in {folder}/results/.store" in output, output
    after = files_of(folder)
    gone = before.keys() - after.keys()
    assert gone and all(before[name] == data for name, data in after.items())
    assert not [name for name in gone if name.endswith(WANTED) or "/11_object/" in name or "/12_evaluate/" in name]
    assert not [name for name in after if "/06_depth/" in name or "/01_frames/" in name or "/07_fusion/" in name]
    assert not (folder / "results/mug/06_depth").exists()
    assert (folder / "results/mug/report.html").read_bytes() == page
    assert run("clean", *words)[1].startswith("Nothing to remove.")


def test_a_run_after_it_does_nothing_and_one_that_needs_more_takes_it_from_the_store(mine):
    folder, run = mine
    before = files_of(folder)
    page = (folder / "results/mug/report.html").stat().st_mtime_ns
    assert run("clean", "mug", "--yes")[0] == 0
    status, output = run("run", "mug.mp4", "--cores", "2")
    assert status == 0, output
    assert (folder / "results/mug/report.html").stat().st_mtime_ns == page
    shutil.rmtree(folder / "results/mug/11_object")
    status, output = run("run", "mug.mp4", "--cores", "2")
    assert status == 0, output
    after = files_of(folder)
    assert "results/mug/11_object/fused_sdf/mesh.ply" in after
    assert after.items() <= before.items()
    said = (folder / "results/logs/run.txt").read_text()
    assert "taken from the store" in said and ": done in" not in said


def test_with_a_changed_parameter_what_was_removed_comes_back(mine):
    folder, run = mine
    assert run("clean", "mug", "--yes")[0] == 0
    status, output = run("run", "mug.mp4", "--cores", "2", "--set", "depth.iterations=3")
    assert status == 0, output
    said = (folder / "results/logs/run.txt").read_text()
    assert "frames of mug: taken from the store" in said and "poses of mug: done" not in said
    assert "iterations=3" in json.loads(next((folder / "results/mug/06_depth").iterdir()).read_text())["params"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ([], "expected the name of a sequence, as in threedfs clean my, or --all."),
        (["mug", "--all"], "expected the name of a sequence"),
        (["cup"], "found no cup; correct it, or use --out."),
        (["logs"], "found no logs"),
        ([".."], "found no .."),
        (["mug", "--out", "elsewhere"], "expected a folder that holds results of runs, found none"),
    ],
)
def test_what_is_not_there_is_refused(mine, capsys, words, sentence):
    folder, _ = mine
    before = files_of(folder)
    assert main(["clean", *words, "--yes"]) == 1
    assert sentence in capsys.readouterr().err
    assert files_of(folder) == before


def test_a_sequence_that_is_not_finished_stays(mine, capsys):
    folder, _ = mine
    (folder / "results/mug/logs/depth.log").write_text("threedfs: depth of mug: too dark.\n")
    before = files_of(folder)
    assert main(["clean", "mug", "--yes"]) == 1
    assert "mug is not: run it to its end first, or delete" in capsys.readouterr().err
    assert main(["clean", "--all", "--yes"]) == 0
    assert "mug is not finished, and stays as it is." in capsys.readouterr().err
    assert files_of(folder) == before


def test_a_failure_of_an_earlier_run_is_no_obstacle(mine):
    """A job that a later run did not need left its log behind, and the report of then told of it."""
    folder, run = mine
    (folder / "results/mug/logs/scale.log").write_text("threedfs: scale of mug: no tag.\n")
    (folder / "results/tables/metrics.csv").unlink()  # as a run with a failure does
    report = json.loads((folder / "results/mug/report.json").read_text())
    (folder / "results/mug/report.json").write_text(json.dumps({**report, "failures": ["scale: no tag."]}))
    assert run("clean", "mug")[0] == 1
    status, output = run("run", "mug.mp4", "--cores", "2")
    assert status == 0, output
    assert json.loads((folder / "results/mug/report.json").read_text())["failures"] == []
    assert run("clean", "mug", "--yes")[0] == 0


def test_figures_stay_wherever_they_are(mine):
    folder, run = mine
    (folder / "results/mug/12_depth_experiment/trials").mkdir(parents=True)
    for name in ("metrics.csv", "trials/a.zarr.zip"):
        (folder / "results/mug/12_depth_experiment" / name).write_text("figures")
    assert run("clean", "mug", "--yes")[0] == 0
    assert (folder / "results/mug/12_depth_experiment/metrics.csv").is_file()
    assert not (folder / "results/mug/12_depth_experiment/trials").exists()


@pytest.mark.parametrize("lock", ["results/logs/run.lock", ".snakemake/run.lock"])
def test_beside_a_run_nothing_is_removed(mine, capsys, lock):
    folder, _ = mine
    before = files_of(folder)
    with open(folder / lock, "a") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        assert main(["clean", "mug", "--yes"]) == 1
    assert "run works in this folder" in capsys.readouterr().err
    assert files_of(folder) == before


def test_links_are_removed_and_not_followed(mine, tmp_path):
    folder, _ = mine
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious/file.bin").write_text("mine")
    (folder / "results/mug/06_depth/link.bin").symlink_to(tmp_path / "precious/file.bin")
    (folder / "results/mug/05_mine").symlink_to(tmp_path / "precious")
    assert main(["clean", "mug", "--yes"]) == 0
    assert (tmp_path / "precious/file.bin").read_text() == "mine" and (folder / "results/mug/05_mine").exists()
