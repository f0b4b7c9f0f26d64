"""Property: of equal jobs one works and the others wait, unless the one has died."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import time

import pytest

from threedfs.store.claims import claim
from threedfs.store.heartbeat import RUN, STALE, beating, is_alive

PROGRAM = """
import io
from pathlib import Path
from threedfs.progress import Progress
from threedfs.store.action import Task
from threedfs.store.perform import perform
folder, log = Path({folder!r}), io.StringIO()
task = Task("join", {{"parts": folder / "a"}}, {{"whole": folder / {name!r}}}, package="toolbox")
print(perform(task, folder / "store", progress=Progress("join", log)).hit, log.getvalue())
"""
SLOW = """
def run(*, parts, whole, job):
    import time
    (parts.parent / f"begun-{time.monotonic_ns()}").touch()
    while not (parts.parent / "go").exists():
        time.sleep(0.01)
    whole.write_text(parts.read_text())
"""


@pytest.fixture
def start(toolbox, tmp_path, spawn):
    """Start a job in a process of its own."""
    (toolbox / "stages" / "join.py").write_text(SLOW)
    (tmp_path / "a").write_text("one")
    return lambda name: spawn(PROGRAM.format(folder=str(tmp_path), name=name))


def wait_until(condition):
    """Wait for a condition, at most for a minute."""
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_of_two_equal_jobs_one_works(start, tmp_path):
    first = start("first")
    wait_until(lambda: list(tmp_path.glob("begun-*")))
    second = start("second")
    wait_until(lambda: len(list((tmp_path / "store/claims").glob("*.beat"))) == 2)
    time.sleep(0.3)
    (tmp_path / "go").touch()
    said = [process.communicate()[0] for process in (first, second)]
    assert said[0].startswith("False") and said[1].startswith("True")
    assert f"waits for process {first.pid} on " in said[1]
    assert len(list(tmp_path.glob("begun-*"))) == 1
    assert (tmp_path / "first").read_text() == (tmp_path / "second").read_text() == "one"
    assert not list((tmp_path / "store/claims").iterdir())


def test_a_killed_job_is_taken_over_and_leaves_no_process(start, tmp_path):
    first = start("first")
    wait_until(lambda: list(tmp_path.glob("begun-*")))
    first.send_signal(signal.SIGKILL)
    first.communicate()
    (tmp_path / "go").touch()
    assert start("second").communicate()[0].startswith("False")
    assert (tmp_path / "second").read_text() == "one"
    wait_until(lambda: not _children_of(tmp_path))


def test_a_job_ends_with_the_run_that_it_is_part_of(start, tmp_path, monkeypatch):
    run = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    monkeypatch.setenv(RUN, f"{socket.gethostname()}.{run.pid}")
    job = start("first")
    wait_until(lambda: list(tmp_path.glob("begun-*")))
    time.sleep(1.2)
    assert job.poll() is None
    run.kill()
    run.wait()
    job.communicate(timeout=30)
    assert job.returncode == -signal.SIGKILL and not (tmp_path / "first").exists()
    monkeypatch.setenv(RUN, f"elsewhere.{run.pid}")  # which cannot be known here
    (tmp_path / "go").touch()
    assert start("second").communicate()[0].startswith("False")


def _children_of(folder):
    """Return the processes whose command names a folder."""
    import psutil

    found = (process.info["cmdline"] or [] for process in psutil.process_iter(["cmdline"]))
    return [words for words in found if any(str(folder) in word for word in words)]


def test_a_claim_of_another_machine_is_held_while_it_beats(tmp_path):
    other = tmp_path / "elsewhere.1.abc.beat"
    other.touch()
    (tmp_path / "key.claim").write_text(json.dumps({"host": "elsewhere", "process": 1, "beat": other.name}))
    said = []
    with beating(tmp_path) as beat:
        assert is_alive(other, time.time())
        os.utime(other, (1, time.time() - STALE - 1))
        with claim(tmp_path, "key", beat, said.append) as waited:
            assert not waited and "elsewhere" not in (tmp_path / "key.claim").read_text()
    assert not (tmp_path / "key.claim").exists() and not said


@pytest.mark.parametrize("what", ["rubbish", "folder", "pipe", "dangling link", "number"])
def test_what_is_no_claim_holds_nobody_up(tmp_path, what):
    place = tmp_path / "key.claim"
    match what:
        case "rubbish":
            place.write_text("{")
            os.utime(place, (1, 1))
        case "folder":
            place.mkdir()
        case "pipe":
            os.mkfifo(place)
        case "dangling link":
            place.symlink_to("nowhere")
        case "number":
            place.write_text("7")
            os.utime(place, (1, 1))
    with beating(tmp_path) as beat, claim(tmp_path, "key", beat, print) as waited:
        assert not waited
    assert not place.exists()


def test_a_claim_that_names_a_path_is_none(tmp_path):
    (tmp_path / "in").mkdir()
    (tmp_path / "elsewhere.1.abc.beat").touch()
    text = json.dumps({"host": "elsewhere", "process": 1, "beat": "../elsewhere.1.abc.beat"})
    (tmp_path / "in/key.claim").write_text(text)
    with beating(tmp_path / "in") as beat, claim(tmp_path / "in", "key", beat, print) as waited:
        assert not waited


def test_the_sign_of_life_is_renewed_and_ends(tmp_path, monkeypatch):
    monkeypatch.setattr("threedfs.store.heartbeat._INTERVAL", 0.1)
    with beating(tmp_path) as beat:
        os.utime(beat, (1, 1))
        wait_until(lambda: beat.stat().st_mtime > 1)
    assert not beat.exists()
