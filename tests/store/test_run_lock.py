"""Property: locks of the dead are cleared, those of the living are not."""

from __future__ import annotations

import os
import signal

import pytest

from threedfs.store.run_lock import take_over

HOLDER = """
from pathlib import Path
from threedfs.store.run_lock import take_over
held = take_over(Path({folder!r}))
print("held", flush=True)
input()
"""


@pytest.fixture
def folder(tmp_path):
    """A folder in which a run left a lock."""
    (tmp_path / "locks").mkdir()
    (tmp_path / "locks" / "0.input.lock").touch()
    return tmp_path


def test_lock_of_a_living_run_stays_and_that_of_a_killed_one_goes(folder, spawn, toolbox):
    process = spawn(HOLDER.format(folder=str(folder)))
    assert process.stdout.readline() == "held\n"
    lock = folder / "locks" / "1.input.lock"
    lock.touch()
    assert take_over(folder, patience=0.2) is None
    assert lock.exists()
    process.send_signal(signal.SIGKILL)
    process.communicate()
    held = take_over(folder, patience=10)
    assert held is not None
    assert not lock.exists()
    held.close()


def test_folder_is_made(tmp_path):
    held = take_over(tmp_path / "new")
    assert held is not None
    held.close()


def test_what_is_no_file_holds_nobody_up(tmp_path):
    os.mkfifo(tmp_path / "run.lock")
    held = take_over(tmp_path, patience=0.2)
    assert held is not None
    held.close()
