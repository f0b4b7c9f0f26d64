"""A sign of life for other machines: a file whose time is renewed for as long as a process runs."""

from __future__ import annotations

import ctypes
import os
import secrets
import signal
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from threedfs.store.files import is_running, make_folder

STALE = 60.0
"""Seconds after which a file that was not renewed is that of a dead process."""
RUN = "THREEDFS_RUN"
"""Environment variable with HOST.PROCESS of the run that a job is part of."""
_INTERVAL = 5.0
_SET_DEATH_SIGNAL = 1  # of Linux's prctl


@contextmanager
def beating(folder: Path) -> Iterator[Path]:
    """Keep a file in `folder` fresh while this process runs; it is gone afterwards.

    A process of its own does it, as kernels and libraries may keep this one busy for minutes, and a thread would be
    lost, or worse, in a fork. It ends with this process, however that ends; and it ends this process if the run that it
    is part of, on the same machine, was killed, as nobody waits for it then.

    Parameters
    ----------
    folder : Path

    Yields
    ------
    Path
        ``HOST.PROCESS.TOKEN.beat``.
    """
    make_folder(folder)
    file = folder / f"{socket.gethostname()}.{os.getpid()}.{secrets.token_hex(4)}.beat"
    file.touch(exist_ok=False)
    parent = os.getpid()
    child = os.fork()
    if child == 0:
        _beat(file, parent)
    try:
        yield file
    finally:
        if os.getpid() == parent:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            file.unlink(missing_ok=True)


def is_alive(file: Path, now: float) -> bool:
    """Say whether the process that keeps a file fresh lives.

    Parameters
    ----------
    file : Path
    now : float
        The time by the clock of the file's own file system.
    """
    try:
        age = now - os.lstat(file).st_mtime
    except OSError:
        return False
    host, _, process = file.name.rsplit(".", 2)[0].rpartition(".")
    if host == socket.gethostname() and process.isdigit() and not is_running(int(process)):
        return False
    return age < STALE


def name_run() -> None:
    """Have all jobs that this process starts end with it."""
    os.environ[RUN] = f"{socket.gethostname()}.{os.getpid()}"


def has_lost_run() -> bool:
    """Say whether the run that this process is part of is known to have ended."""
    host, _, process = os.environ.get(RUN, "").rpartition(".")
    return host == socket.gethostname() and process.isdigit() and not is_running(int(process))


def read_clock(file: Path) -> float:
    """Return the time by the clock of a file system, by renewing a file on it."""
    os.utime(file)
    return os.stat(file).st_mtime


def _beat(file: Path, parent: int) -> None:
    """Renew a file until the parent ends; never return."""
    try:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            # what ends the parent ends this process; what the parent survives, it survives
            signal.signal(number, signal.SIG_IGN)
        if sys.platform == "linux":
            ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in range(3):
            os.dup2(nothing, stream)
        os.closerange(3, 256)  # pipes that others wait to be closed
        last = time.monotonic()
        while os.getppid() == parent:
            time.sleep(0.5)
            if has_lost_run():
                os.kill(parent, signal.SIGKILL)
            if time.monotonic() - last >= _INTERVAL:
                last = time.monotonic()
                os.utime(file)
    finally:
        os._exit(0)
