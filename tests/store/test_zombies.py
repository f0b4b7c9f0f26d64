"""Exact: what a process left that has ended, but is still listed, counts as abandoned."""

import socket
import subprocess
import sys
import time

from threedfs.store.files import remove_abandoned


def test_leavings_of_a_zombie_are_removed(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", ""])
    end = time.monotonic() + 20
    while time.monotonic() < end:
        with open(f"/proc/{child.pid}/stat", encoding="ascii") as file:
            if ") Z " in file.read():
                break
        time.sleep(0.02)
    left = tmp_path / f".key.{socket.gethostname()}.{child.pid}.part"
    left.mkdir()
    remove_abandoned(tmp_path)
    child.wait()
    assert not left.exists()
