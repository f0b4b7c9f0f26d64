"""Contract: how a job ends, in its log and on the terminal."""

from __future__ import annotations

import io

import pytest

from threedfs.store.command import Tee, run_job

REFUSING = """
from threedfs.errors import UserError

def run(*, parts, whole, job):
    whole.write_text("half")
    raise {fault}
"""


@pytest.fixture
def log(tmp_path):
    """Where the job writes its log."""
    return tmp_path / "logs" / "join.log"


@pytest.fixture
def job(toolbox, tmp_path, log):
    """Run the stage `join` of the toolbox as a job; return its log."""
    (tmp_path / "a").write_text("one")

    def work(wildcards, labels=None):
        inputs, outputs, store = {"parts": tmp_path / "a"}, {"whole": tmp_path / "whole"}, tmp_path / "store"
        options = {"store": store, "log": log, "threads": 1, "seed": 0, "package": "toolbox"}
        run_job("join", inputs, outputs, {}, wildcards, labels or {}, **options)
        return log.read_text()

    return work


def test_log_tells_what_was_done_and_names_the_action(job, capsys):
    first, again = job({"sequence": "mug"}), job({"sequence": "cup"})
    assert first.startswith("join of mug: at work\njoin of mug: done in ")
    assert again.startswith("join of cup: taken from the store in ")
    assert first.splitlines()[-1] == again.splitlines()[-1]
    assert first.splitlines()[-1].startswith("action ")
    assert "join of mug: at work\n" in capsys.readouterr().err


def test_labels_count_but_the_sequence_does_not(job):
    keys = [job({"sequence": name}, {"dataset": label}).split()[-1] for name, label in ("ax", "bx", "by")]
    assert keys[0] == keys[1] != keys[2]


def test_refusal_is_one_sentence_and_status_1_and_no_output(job, toolbox, log, tmp_path, capsys):
    (toolbox / "stages" / "join.py").write_text(REFUSING.format(fault="UserError('this is no video.')"))
    with pytest.raises(SystemExit) as ended:
        job({"sequence": "mug"})
    assert ended.value.code == 1
    assert not (tmp_path / "whole").exists()
    assert capsys.readouterr().err == log.read_text() == "threedfs: join of mug: this is no video.\n"


def test_fault_of_the_program_leaves_its_traceback_in_the_log(job, toolbox, log):
    (toolbox / "stages" / "join.py").write_text(REFUSING.format(fault="ZeroDivisionError"))
    with pytest.raises(ZeroDivisionError):
        job({"sequence": "mug"})
    assert "Traceback" in log.read_text() and "ZeroDivisionError" in log.read_text()


def test_lines_leave_whole():
    streams = io.StringIO(), io.StringIO()
    tee = Tee(*streams)
    tee.write("half")
    assert [stream.getvalue() for stream in streams] == ["", ""]
    tee.write(" a line\nand")
    assert [stream.getvalue() for stream in streams] == ["half a line\n"] * 2
