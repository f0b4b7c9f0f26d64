"""Digests of what a job reads: files, folders, and the slice of a file that one job looks at."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

from threedfs.errors import UserError
from threedfs.io.schema import KEYFRAMES
from threedfs.store.files import write_atomically


def canonical_json(value: Any) -> bytes:
    """Encode plain values so that equal values have equal bytes."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def digest_value(value: Any) -> str:
    """Return the SHA-256 of the canonical JSON of a plain value."""
    return hashlib.sha256(canonical_json(value)).hexdigest()


class Guard(Protocol):
    """What knows the bytes that results of jobs had when they were put in their places."""

    def settle(self, path: Path, digest: str) -> str:
        """Return the digest of a file as its job wrote it, having put that back if another one was found."""

    def fill(self, path: Path) -> None:
        """Put back a result, or files of a folder of results, that are missing."""


_CONFIRMED: dict[str, list[int]] = {}
"""Stamps of the files that this process, or the one it was forked from, has hashed or written itself."""


class InputDigests:
    """Digests of input files, remembered by path, size, modification time and inode.

    Parameters
    ----------
    folder : Path
        Where they are remembered.
    guard : Guard or None
        Is asked about every file that is hashed.
    thorough : bool
        Hash every file once in this process, whatever is remembered.
    """

    def __init__(self, folder: Path, guard: Guard | None = None, thorough: bool = False) -> None:
        self.folder = folder
        self.guard = guard
        self.thorough = thorough

    def file(self, path: Path) -> str:
        """Return the SHA-256 of a file's content."""
        stamp = _stamp(path)
        if not self.thorough or _CONFIRMED.get(os.path.abspath(path)) == stamp:
            remembered = self._remembered(path, stamp)
            if remembered is not None:
                return remembered
        digest = _hash_file(path)
        if self.guard is not None:
            settled = self.guard.settle(path, digest)
            if settled != digest:  # it was put back, and remembered
                return settled
        if _stamp(path) == stamp:  # else it was written to meanwhile
            self.remember(path, digest)
        return digest

    def remember(self, path: Path, digest: str) -> None:
        """Note the digest of a file that was just written or read whole; where notes cannot be written, do not."""
        stamp = _stamp(path)
        _CONFIRMED[os.path.abspath(path)] = stamp
        try:
            write_atomically(self._note(path), _render_note(path, digest, stamp))
        except OSError:  # the store is full or only read: the file is hashed again next time
            pass

    def folder_of_files(self, path: Path) -> str:
        """Digest a folder: the relative names and contents of its files, without hidden ones."""
        files = (file for file in sorted(path.rglob("*")) if file.is_file())
        names = ((file.relative_to(path), file) for file in files)
        return digest_value(
            [[name.as_posix(), self.file(file)] for name, file in names if not _is_hidden(name)],
        )

    def any(self, path: Path) -> str:
        """Digest a file or a folder.

        Raises
        ------
        UserError
            If there is neither.
        """
        if self.guard is not None and (path.is_dir() or not path.exists()):
            self.guard.fill(path)
        if path.is_dir():
            return self.folder_of_files(path)
        if path.is_file():
            return self.file(path)
        raise UserError(f"{path}: expected a file or folder, found none; check the path in the configuration.")

    def inputs(
        self, inputs: Mapping[str, Path | list[Path] | None], keyframe: str | None
    ) -> dict[str, str | list[list[str]] | None]:
        """Digest the inputs of a job by name.

        Of a keyframes file, a job that works on one keyframe sees only that entry: the digest is the entry's, so
        that a change to another keyframe does not count.

        Parameters
        ----------
        inputs : mapping of str to Path, list of Path, or None
        keyframe : str or None
            The keyframe the job works on.
        """
        return {name: self._one(value, keyframe) for name, value in inputs.items()}

    def _one(self, value: Path | list[Path] | None, keyframe: str | None) -> str | list[list[str]] | None:
        if value is None:
            return None
        if isinstance(value, list):
            return [[path.name, self.any(path)] for path in value]
        if keyframe is not None and value.suffix == ".json" and value.is_file():
            self.file(value)  # it is put right before it is read
            entries = _read_keyframes(value, *_stamp(value))
            if entries is not None:
                return digest_value(entries.get(keyframe))
        return self.any(value)

    def _note(self, path: Path) -> Path:
        name = hashlib.sha256(os.path.abspath(path).encode()).hexdigest()
        return self.folder / name[:2] / f"{name}.json"

    def _remembered(self, path: Path, stamp: list[int]) -> str | None:
        """Return what is noted of a file if it has not changed since, and the note is whole."""
        try:
            data = self._note(path).read_bytes()
            digest = json.loads(data)["sha256"]
            whole = data == _render_note(path, digest, stamp)
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return None
        return digest if whole else None


def _render_note(path: Path, digest: str, stamp: list[int]) -> bytes:
    note = {"path": os.path.abspath(path), "sha256": digest, "stamp": stamp}
    return canonical_json({**note, "check": digest_value(note)})


@lru_cache(maxsize=8)
def _read_keyframes(path: Path, *_stamp: int) -> dict[str, Any] | None:
    """Return the entries of a keyframes file, or None for any other; the stamp makes the cache notice edits."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        return None  # a user's file that is no JSON: the stage says so
    is_keyframes = isinstance(content, dict) and content.get("schema") == KEYFRAMES.name
    return content["keyframes"] if is_keyframes else None


def _stamp(path: Path) -> list[int]:
    status = os.stat(path)
    return [status.st_size, status.st_mtime_ns, status.st_ino, status.st_dev]


def _hash_file(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _is_hidden(name: Path) -> bool:
    return any(part.startswith(".") for part in name.parts)
