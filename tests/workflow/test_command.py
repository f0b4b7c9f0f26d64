"""Workflow: the command on a copy of the project whose stages are stand-ins."""

from __future__ import annotations

import fcntl
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml

import threedfs.cli.main as command
from threedfs.params.configuration import METHODS

ROOT = Path(__file__).resolve().parents[2]
STATIC = "static: the camera hardly moves."


@pytest.fixture
def call(project, tmp_path):
    """Call the copy's command in an empty folder; return status and output."""

    return lambda *words: project.call(tmp_path, *words)


def test_a_video_of_any_name_is_reconstructed_in_another_folder(call, tmp_path):
    (tmp_path / "My Video (1).mov").write_text("film")
    status, output = call("run", "My Video (1).mov", "--out", "made", "--cores", "2")
    assert status == 0, output
    folder = tmp_path / "made/results/My_Video_1"
    assert "My Video (1).mov is called My_Video_1" in output
    assert f"detail   {folder}/11_object/fused_sdf/mesh.ply" in output
    assert "%  0:" in output and "time     0:" in output
    assert (tmp_path / "made/results/logs/run.txt").is_file() and not (tmp_path / "results").exists()


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["lost.mp4"], "lost.mp4: expected a video or a folder of photos, found nothing there."),
        (["mug.mp4", "--height", "tall"], "--height: expected a length such as 95mm"),
        (["mug.mp4", "--set", "depth"], "--set: expected STAGE.PARAMETER=VALUE"),
        (["mug.mp4", "--set", "depth.iteration=5"], "configuration, depth: unknown key iteration"),
        (
            ["mug.mp4", "--set", "depth.iterations=many"],
            "configuration, depth.iterations: expected integer, got 'many'",
        ),
        (["mug.mp4", "--set", "nothing=5"], "configuration: unknown key nothing"),
        (["mug.mp4", "--set", "sequences=3"], "--set: expected a parameter, got sequences"),
        (["mug.mp4", "--height", ""], "--height: expected a length"),
        (["mug.mp4", "--out", "mug.mp4"], "--out: expected a folder to write results to"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(call, tmp_path, words, sentence):
    (tmp_path / "mug.mp4").write_text("film")
    status, output = call("run", *words)
    assert status == 1
    assert f"threedfs: {sentence}" in output
    assert "Traceback" not in output
    assert not list(tmp_path.glob("results/*/1*"))


def test_a_request_is_kept_with_its_quality_and_not_replaced_by_one_that_is_refused(call, tmp_path):
    (tmp_path / "mug.mp4").write_text("film")
    request = tmp_path / "results/mug/request.yaml"
    assert call("run", "mug.mp4", "--set", "depth.iterations=none")[0] == 1
    assert not request.exists()
    assert call("run", "mug.mp4", "--quality", "draft", "--set", "depth.smoothness=0.02", "--cores", "2")[0] == 0
    kept = yaml.safe_load(request.read_text())
    draft = yaml.safe_load((ROOT / "config/presets/draft.yaml").read_text())
    assert kept["depth"] == draft["depth"] | {"smoothness": 0.02} and kept["crops"] == draft["crops"]
    status, output = call("run", "mug.mp4", "--set", "depth.iterations=none")
    assert status == 1 and "report.html" not in output
    assert yaml.safe_load(request.read_text()) == kept


def test_another_file_of_the_same_name_is_refused(call, tmp_path):
    for name in ("mug.mp4", "mug.mov"):
        (tmp_path / name).write_text(name)
    assert call("run", "mug.mp4", "--cores", "2")[0] == 0
    status, output = call("run", "mug.mov")
    assert status == 1 and f"holds the results of {tmp_path}/mug.mp4; rename the file, or use --out." in output


def test_a_second_command_in_the_same_folder_waits_its_turn(call, tmp_path):
    (tmp_path / "mug.mp4").write_text("film")
    (tmp_path / "results/logs").mkdir(parents=True)
    with open(tmp_path / "results/logs/run.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        status, output = call("run", "mug.mp4")
    assert status == 1 and "another run works in this folder" in output


def test_of_two_videos_only_the_one_that_ended_well_is_announced(call, project, tmp_path):
    for name in ("mug", "cup"):
        (tmp_path / f"{name}.mp4").write_text(name)
        (tmp_path / f"results/{name}/11_object/fused_sdf").mkdir(parents=True)
    project.edit(
        "src/threedfs/stages/frames.py",
        "    write(",
        "    from threedfs.errors import UserError\n"
        f"    if source.stem == 'mug':\n        raise UserError({STATIC!r})\n    write(",
    )
    status, output = call("run", "mug.mp4", "cup.mp4")
    assert status == 1
    assert "cup/11_object/fused_sdf/mesh.ply" in output and "mug/11_object" not in output
    assert f"threedfs: frames of mug: {STATIC}" in output
    assert f"report   {tmp_path}/results/mug/report.html" in output


def test_a_name_that_snakemake_would_change_is_refused_in_one_sentence(call, tmp_path):
    (tmp_path / "a-b <results>.mp4").write_text("film")
    status, output = call("run", "./a-b <results>.mp4")
    assert status == 1
    assert "source: expected a path without <results>" in output.rstrip().splitlines()[-1]


def test_a_job_that_fails_ends_in_its_sentence(call, project, tmp_path):
    (tmp_path / "mug.mp4").write_text("film")
    project.edit(
        "src/threedfs/stages/poses.py",
        "    write(",
        f"    from threedfs.errors import UserError\n    raise UserError({f'poses: {STATIC}'!r})\n    write(",
    )
    (tmp_path / "results/mug/11_object/fused_sdf").mkdir(parents=True)
    (tmp_path / "results/mug/11_object/fused_sdf/mesh.ply").write_text("of an earlier run")
    status, output = call("run", "mug.mp4")
    assert status == 1 and "mesh.ply" not in output and "time " not in output
    assert output.rstrip().splitlines()[-1] == f"threedfs: poses of mug: {STATIC}"
    assert output.count(STATIC) == 1
    assert "camera hardly moves" in (tmp_path / "results/mug/report.html").read_text()


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_run_says_how_to_go_on_leaves_nobody_and_is_resumed(project, call, tmp_path, how):
    """Exact: after the same command once more all is as if it had not been stopped."""
    (tmp_path / "mug.mp4").write_text("film")
    slow = tmp_path / "slow"
    slow.touch()
    waiting = f"    import time\n    time.sleep(60 if Path({str(slow)!r}).exists() else 0)\n    write("
    project.edit("src/threedfs/stages/poses.py", "    write(", waiting)
    running = subprocess.Popen(
        [sys.executable, "-m", "threedfs.cli.main", "run", "mug.mp4"],
        cwd=tmp_path,
        env=project.forking,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    until = time.monotonic() + 60
    while not (tmp_path / "results/mug/logs/poses.log").is_file() and time.monotonic() < until:
        time.sleep(0.2)
    running.send_signal(how)
    output = running.communicate(timeout=60)[0]
    assert running.returncode == 130
    said = output.rstrip().splitlines()
    assert said[-1] == "threedfs: not finished; run the same command again to resume."
    assert "Traceback" not in output and output.count("not finished") == 1
    until = time.monotonic() + 5
    while _processes_in(tmp_path) and time.monotonic() < until:
        time.sleep(0.2)
    assert not _processes_in(tmp_path)
    if how != signal.SIGINT:  # what is left behind is the same
        return
    slow.unlink()
    status, output = call("run", "mug.mp4")
    assert status == 0, output
    log = (tmp_path / "results/logs/run.txt").read_text()
    assert "poses of mug: done in" in log and "(Rule: frames)" not in log
    assert call("run", "mug.mp4", "--out", "whole")[0] == 0
    assert _artifacts(tmp_path) == _artifacts(tmp_path / "whole")


def _artifacts(folder):
    """Read a sequence's results by name, without what tells times."""
    own = (path for path in (folder / "results/mug").rglob("*") if path.is_file())
    kept = (path for path in own if not {"logs", "benchmarks", "report.html"} & set(path.parts))
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in kept}


def _processes_in(folder):
    """Return the command lines of processes that work in a folder."""
    import psutil

    found = []
    for process in psutil.process_iter(["cwd", "cmdline"]):
        if process.info["cwd"] == str(folder):
            found.append(process.info["cmdline"])
    return found


def test_every_method_is_explained(capsys):
    assert command.main(["methods"]) == 0
    assert {line.split()[0] for line in capsys.readouterr().out.splitlines()} == set(METHODS)


def test_a_report_that_is_not_there_is_named(capsys, tmp_path):
    assert command.main(["show", str(tmp_path)]) == 1
    assert "expected the report of a run, found none" in capsys.readouterr().err
