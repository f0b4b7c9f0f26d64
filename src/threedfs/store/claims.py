"""Work that one process has begun and others wait for, instead of doing it too."""

from __future__ import annotations

import json
import os
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from threedfs.store.files import is_running, make_folder, read_regular, remove
from threedfs.store.heartbeat import STALE, is_alive, read_clock

_LONGEST_WAIT = 2.0  # seconds between two looks


@contextmanager
def claim(folder: Path, key: str, beat: Path, tell: Callable[[str], None]) -> Iterator[bool]:
    """Begin an action, once nobody else who lives is at it.

    If two take over from a dead one in the same moment, both do the work: it comes to the same bytes.

    Parameters
    ----------
    folder : Path
        Holds a file for each action that is being done.
    key : str
        The action's.
    beat : Path
        The sign of life of this process, or of the one that it was forked from.
    tell : callable
        Takes a sentence.

    Yields
    ------
    bool
        Whether it had to wait: the store may have the result now.
    """
    make_folder(folder)
    place, waited, pause = folder / f"{key}.claim", False, 0.05
    text = json.dumps({"host": socket.gethostname(), "process": os.getpid(), "beat": beat.name}).encode()
    while not _create(place, text):
        holder = find_holder(place, beat)
        if holder is None:
            remove(place)
            continue
        if not waited:
            tell(f"waits for {holder}, which does the same work")
            waited = True
        time.sleep(pause)
        pause = min(2 * pause, _LONGEST_WAIT)
    try:
        yield waited
    finally:
        if _read(place) == text:  # else another took it over, as this process had seemed dead
            place.unlink(missing_ok=True)


def find_holder(place: Path, beat: Path) -> str | None:
    """Return who holds a claim, or None if nobody who lives does.

    Parameters
    ----------
    place : Path
        The claim.
    beat : Path
        A file to read the file system's clock with.
    """
    now = read_clock(beat)
    try:
        content = json.loads(_read(place))
        host, process, other = content["host"], int(content["process"]), place.parent / Path(content["beat"]).name
    except (ValueError, KeyError, TypeError, RecursionError):
        # being written in this moment, or damaged
        try:
            return "another job" if now - os.lstat(place).st_mtime < STALE and place.is_file() else None
        except FileNotFoundError:
            return None
    if not is_alive(other, now):
        return None
    if host == socket.gethostname() and not is_running(process):  # a worker has died, its job lives
        return None
    return f"process {process} on {host}"


def _create(place: Path, text: bytes) -> bool:
    try:
        descriptor = os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
    except FileExistsError:
        return False
    with open(descriptor, "wb") as file:
        file.write(text)
    return True


def _read(place: Path) -> bytes:
    try:
        return read_regular(place)
    except OSError:
        return b""
