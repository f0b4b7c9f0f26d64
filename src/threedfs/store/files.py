"""Files that appear whole or not at all, and the clearing away of what killed jobs left."""

from __future__ import annotations

import errno
import os
import shutil
import socket
import stat
from io import BufferedReader
from pathlib import Path

_SUFFIX = ".part"


def temporary_name(path: Path) -> Path:
    """Return a hidden name beside `path` that tells which process of which machine writes it."""
    return path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}{_SUFFIX}")


def write_atomically(path: Path, data: bytes) -> None:
    """Write a small file: to a temporary name, flushed, then renamed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = temporary_name(path)
    remove(temporary)  # of a killed process with our number
    try:
        with open(temporary, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def open_regular(path: Path) -> BufferedReader:
    """Open a file to read if it is one: never through a link, and never waiting on a pipe.

    Raises
    ------
    OSError
        If there is something else, or nothing.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "expected a file, found a folder, a pipe or a device", str(path))
    return open(descriptor, "rb")


def read_regular(path: Path) -> bytes:
    """Return the bytes of a file, as `open_regular` opens it."""
    with open_regular(path) as file:
        return file.read()


def make_folder(folder: Path) -> None:
    """Make a folder; what is none and lies in its place is removed."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        remove(folder)
        folder.mkdir(parents=True, exist_ok=True)


def flush_folder(folder: Path) -> None:
    """Flush a folder's entries to disk, so that a rename in it survives a power cut."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def remove(path: Path) -> None:
    """Remove a file or folder if it is there."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def remove_abandoned(folder: Path, pattern: str = "*") -> None:
    """Remove temporary files and folders whose process on this machine has ended.

    Parameters
    ----------
    folder : Path
    pattern : str
        Glob of the final names to look at.
    """
    for path in folder.glob(f".{pattern}.{socket.gethostname()}.*{_SUFFIX}"):
        process = path.name.removesuffix(_SUFFIX).rpartition(".")[2]
        if process.isdigit() and not is_running(int(process)):
            remove(path)


def is_running(process: int) -> bool:
    """Say whether a process of this machine lives."""
    if _is_zombie(process):
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


def _is_zombie(process: int) -> bool:
    """Say whether a process has ended but is still listed, because nobody has asked for its exit status."""
    try:
        status = Path(f"/proc/{process}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False
    return status.rpartition(")")[2].split()[0] in ("Z", "X")
