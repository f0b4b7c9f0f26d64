"""Compiled kernels on disk: sealed against damage, and read only where nobody else can have put them.

numba unpickles what it keeps, so whoever can write a kernel's file can run code as its reader.
"""

from __future__ import annotations

import atexit
import grp
import hashlib
import os
import pwd
import stat
import tempfile
from pathlib import Path

from threedfs.store.files import open_regular, remove, write_atomically

ENDING = ".kernel"
_SEAL = 64  # hexadecimal digits of SHA-256, before the kernel


def choose_folder(store: Path) -> tuple[Path, str]:
    """Return the folder that kernels are kept in, and why it is not the store's (empty if it is).

    The store's own is taken if it and the store belong to this user and only this user can write to them; else one in
    the user's cache; else, if that cannot be had either, one that is forgotten.
    """
    kept = store / "kernels"
    if _make_private(kept) and is_private(store):
        return kept, ""
    reason = f"{kept} can be written to by others or belongs to another, so compiled kernels are kept in"
    cache = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache").expanduser() / "threedfs" / "kernels"
    if cache.is_absolute() and _make_private(cache):
        return cache, f"{reason} {cache}"
    forgotten = Path(tempfile.mkdtemp(prefix="threedfs-kernels-"))
    atexit.register(remove, forgotten)
    return forgotten, f"{reason} no place, and are compiled again next time"


def is_private(path: Path) -> bool:
    """Say whether a folder belongs to this user, is no link, and nobody else can write to it."""
    try:
        status = os.lstat(path)
    except OSError:
        return False
    return stat.S_ISDIR(status.st_mode) and _is_own(status)


def seal(place: str, content: bytes) -> bytes:
    """Return the bytes of a kernel's file: a checksum of where it belongs and what it holds, and its content."""
    return hashlib.sha256(place.encode() + b"\0" + content).hexdigest().encode() + content


def write_kernel(root: Path, path: Path, content: bytes) -> None:
    """Write a kernel's file, which only this user can write to.

    Parameters
    ----------
    root : Path
        The folder of all kernels; `path` lies in it.
    path : Path
    content : bytes
    """
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    if path.is_dir():
        remove(path)
    write_atomically(path, seal(path.relative_to(root).as_posix(), content))
    os.chmod(path, 0o600)


def read_kernel(root: Path, path: Path) -> bytes | None:
    """Return the content of a kernel's file, or None if there is none that can be trusted."""
    try:
        with open_regular(path) as file:
            if not _is_own(os.fstat(file.fileno())):
                return None
            data = file.read()
    except OSError:
        return None
    content = data[_SEAL:]
    return content if seal(path.relative_to(root).as_posix(), content) == data else None


def _make_private(folder: Path) -> bool:
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError:
        return False
    return is_private(folder) and os.access(folder, os.W_OK)


def _is_own(status: os.stat_result) -> bool:
    shared = stat.S_IWOTH if _is_alone_in(status.st_gid) else stat.S_IWOTH | stat.S_IWGRP
    return status.st_uid == os.geteuid() and not status.st_mode & shared


def _is_alone_in(group: int) -> bool:
    """Say whether a group is a user's own, as many systems make one for each user."""
    try:
        user, entry = pwd.getpwuid(os.geteuid()), grp.getgrgid(group)
    except KeyError:
        return False
    return user.pw_gid == group and entry.gr_name == user.pw_name and not {*entry.gr_mem} - {user.pw_name}
