"""What is remembered of files that were looked at, so that they are looked at once."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from threedfs.store.digests import digest_value
from threedfs.store.files import write_atomically


def remember(folder: Path, paths: Iterable[Path], given: Any, look: Callable[[], Sequence[str]]) -> tuple[str, ...]:
    """Return what a look at files says, from memory if they and what else counts are what they were.

    A look that fails is not remembered.

    Parameters
    ----------
    folder : Path
        Holds the memory.
    paths : iterable of Path
        Files and folders looked at; told apart by the size, time and inode of each file.
    given : JSON value
        What else counts.
    look : callable
        Returns sentences.
    """
    stamps = [[str(path), _stamp(path)] for path in paths]
    note = folder / f"{digest_value([stamps, given])}.json"
    try:
        return tuple(json.loads(note.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        pass
    said = tuple(look())
    write_atomically(note, json.dumps(said).encode())
    return said


def _stamp(path: Path) -> list[list[Any]]:
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    return [[str(file), *_numbers(file)] for file in files]


def _numbers(file: Path) -> tuple[int, ...]:
    try:
        found = os.stat(file)
    except OSError:  # such as a link that leads nowhere
        return ()
    return found.st_size, found.st_mtime_ns, found.st_ino
