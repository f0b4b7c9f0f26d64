"""Jobs that a killed run has left on a Slurm cluster: they end by themselves, and their work counts."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

_OF_A_RULE = "rule_"  # how the comments of jobs begin that Snakemake's executor submits


def wait_for_leftovers(folder: Path, note: Callable[[str], None], pause: float = 5.0) -> None:
    """Wait until no job of an earlier run is at work in a folder; cancel those that have not begun.

    Two jobs must not make the same files at once, and what a running job has done so far is not to be lost: when it
    ends, the store has its work. Without Slurm there is nothing to wait for.

    Parameters
    ----------
    folder : Path
        Where the earlier run was started.
    note : callable
        Takes a sentence when there is something to wait for.
    pause : float
        Seconds between two looks.
    """
    told = False
    while left := _list_leftovers(folder):
        pending = [job for job, state in left.items() if state == "PENDING"]
        if pending:
            subprocess.run(["scancel", *pending], check=False)
        running = [job for job in left if job not in pending]
        if running and not told:
            note(
                f"{len(running)} jobs of an earlier run are still at work here ({', '.join(running[:5])}"
                f"{', ...' if len(running) > 5 else ''}): waiting for their results; scancel them to go on without."
            )
            told = True
        time.sleep(pause if running else 0.5)


def _list_leftovers(folder: Path) -> dict[str, str]:
    """Return the states of the user's jobs that work in a folder for a rule, by their names in Slurm."""
    if shutil.which("squeue") is None:
        return {}
    listed = subprocess.run(
        ["squeue", "--me", "--noheader", "--format=%i|%T|%k|%Z"], capture_output=True, text=True, check=False
    ).stdout
    rows = [line.split("|", 3) for line in listed.splitlines() if line.count("|") >= 3]
    own = os.environ.get("SLURM_JOB_ID", "")  # this run itself may be a job
    here = os.path.realpath(folder)
    return {
        job: state
        for job, state, comment, where in rows
        if comment.startswith(_OF_A_RULE) and os.path.realpath(where) == here and job.partition("_")[0] != own
    }
