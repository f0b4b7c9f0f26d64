"""Digests of what a job reads: files, folders, and the slice of a file that one job looks at."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.io.schema import KEYFRAMES
from threedfs.store.files import write_atomically


def canonical_json(value: Any) -> bytes:
    """Encode plain values so that equal values have equal bytes."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False).encode()


def digest_value(value: Any) -> str:
    """Return the SHA-256 of the canonical JSON of a plain value."""
    return hashlib.sha256(canonical_json(value)).hexdigest()


class InputDigests:
    """Digests of input files, remembered by path, size, modification time and inode.

    Parameters
    ----------
    folder : Path
        Where they are remembered.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def file(self, path: Path) -> str:
        """Return the SHA-256 of a file's content."""
        stamp = _stamp(path)
        note = self._note(path)
        try:
            remembered = json.loads(note.read_text())
            if remembered["stamp"] == stamp:
                return remembered["sha256"]
        except (OSError, ValueError, KeyError, TypeError):
            pass
        digest = _hash_file(path)
        if _stamp(path) == stamp:  # else it was written to meanwhile
            self.remember(path, digest)
        return digest

    def remember(self, path: Path, digest: str) -> None:
        """Note the digest of a file that was just written whole."""
        content = {"path": os.path.abspath(path), "sha256": digest, "stamp": _stamp(path)}
        write_atomically(self._note(path), canonical_json(content))

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
            entries = _read_keyframes(value, *_stamp(value))
            if entries is not None:
                return digest_value(entries.get(keyframe))
        return self.any(value)

    def _note(self, path: Path) -> Path:
        name = hashlib.sha256(os.path.abspath(path).encode()).hexdigest()
        return self.folder / name[:2] / f"{name}.json"


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
