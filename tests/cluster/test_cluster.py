"""What this machine's own Slurm makes of the workflow; skipped where there is no Slurm and none can be installed."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from threedfs.store.leftovers import wait_for_leftovers

HERE = Path(__file__).parent
RULES = HERE.parents[1] / "workflow/rules"


def test_every_rule_names_its_memory_and_its_time():
    for file in RULES.glob("*.smk"):
        for rule in re.split(r"^(?:rule|checkpoint) ", file.read_text(), flags=re.MULTILINE)[1:]:
            name = rule.partition(":")[0]
            assert "mem_mb=" in rule and "runtime=minutes(" in rule, name
            # numbers alone would not grow when a job is tried again
            assert not re.search(r"mem_mb=\d", rule), name


@pytest.fixture
def slurm_with(tmp_path, monkeypatch):
    """Return a function that puts a squeue and a scancel on the path, of which the first prints some lines once."""

    def put(*lines: str) -> Path:
        (tmp_path / "listed").write_text("".join(f"{line}\n" for line in lines))
        for name, text in {
            "squeue": f"cat {tmp_path}/listed; : > {tmp_path}/listed",
            "scancel": f'echo "$@" >> {tmp_path}/cancelled',
        }.items():
            (tmp_path / name).write_text(f"#!/bin/sh\n{text}\n")
            (tmp_path / name).chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
        return tmp_path / "cancelled"

    return put


def test_running_jobs_of_an_earlier_run_are_waited_for_and_waiting_ones_cancelled(slurm_with, tmp_path):
    cancelled = slurm_with(
        f"7|RUNNING|rule_depth_wildcards_a|{tmp_path}",
        f"8|PENDING|rule_depth_wildcards_b|{tmp_path}",
        f"9_[2-5]|PENDING|rule_frames|{tmp_path}",
    )
    told = []
    wait_for_leftovers(tmp_path, told.append, pause=0.01)
    assert cancelled.read_text().split() == ["8", "9_[2-5]"]
    assert len(told) == 1 and "1 jobs of an earlier run are still at work here (7)" in told[0]


def test_other_jobs_are_left_alone(slurm_with, tmp_path, monkeypatch):
    monkeypatch.setenv("SLURM_JOB_ID", "3")
    cancelled = slurm_with(
        f"1|RUNNING|rule_depth|{tmp_path}/elsewhere", f"2|PENDING|a shell|{tmp_path}", f"3|RUNNING|rule_x|{tmp_path}"
    )
    told = []
    wait_for_leftovers(tmp_path, told.append, pause=0.01)
    assert not told and not cancelled.exists()


def test_the_sample_made_on_a_slurm_of_its_own_has_the_same_bytes(tmp_path):
    """Two nodes; every stage a stand-in, as the real ones take minutes: `make cluster-test` runs them."""
    sys.path.insert(0, str(HERE))
    try:
        from private_slurm import can_install, find_missing
    finally:
        sys.path.remove(str(HERE))
    if importlib.util.find_spec("snakemake_executor_plugin_slurm") is None:
        pytest.skip("needs Snakemake's plugin for Slurm: make setup-slurm")
    if missing := find_missing():
        how = "make cluster-test installs them" if can_install() else "install slurm-wlm and munge"
        pytest.skip(f"needs {', '.join(missing)}: {how}")
    command = [sys.executable, str(HERE / "run_cluster.py"), "--stubs", "--target", "02_poses/poses.json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "the same bytes as by a local run" in done.stdout
