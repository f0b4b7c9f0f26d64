"""The bytes that results had when they were put in their places: what they are held against when a job takes them."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from threedfs.errors import UserError
from threedfs.store.digests import canonical_json, digest_value
from threedfs.store.files import read_regular, write_atomically
from threedfs.store.objects import DamagedObject, Objects
from threedfs.store.records import Content, is_digest, is_plain_name


class Made:
    """Notes of what jobs put into a folder of results.

    They lie with the results, not in the store, as another store may have made what is there now.

    Parameters
    ----------
    folder : Path
        Holds the notes; it lies in the folder of results.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def remember(self, path: Path, content: Content) -> None:
        """Note what was put in a place; nothing is noted of a place outside of the results."""
        name = self._name(path)
        if name is None:
            return
        note = {"path": name, "content": content}
        try:
            write_atomically(self._note(name), canonical_json({**note, "check": digest_value(note)}) + b"\n")
        except OSError:  # results are there, if less well guarded
            pass

    def forget(self, path: Path) -> None:
        """Take the note of a place away."""
        name = self._name(path)
        if name is not None:
            self._note(name).unlink(missing_ok=True)

    def find(self, path: Path) -> Content | None:
        """Return what was put in a place, as itself or with a folder around it; None if that is not known."""
        name = self._name(path)
        if name is None:
            return None
        content = self._read(self._note(name), name)
        if content is not None:
            return content
        parts = name.split("/")
        for count in range(len(parts) - 1, 0, -1):
            folder = "/".join(parts[:count])
            content = self._read(self._note(folder), folder)
            if isinstance(content, dict):
                return content.get("/".join(parts[count:]))
        return None

    def list_all(self) -> Iterator[tuple[Path, Content]]:
        """Yield every place that is noted, and what was put there; damaged notes are left out."""
        for note in sorted(self.folder.glob("*/*.json")):
            try:
                name = json.loads(read_regular(note))["path"]
            except (OSError, ValueError, KeyError, TypeError, RecursionError):
                continue
            content = self._read(note, name) if is_plain_name(name) else None
            if content is not None:
                yield self.folder.parent / name, content

    def _name(self, path: Path) -> str | None:
        name = os.path.relpath(os.path.abspath(path), os.path.abspath(self.folder.parent)).replace(os.sep, "/")
        return name if is_plain_name(name) else None

    def _note(self, name: str) -> Path:
        digest = digest_value(name)
        return self.folder / digest[:2] / f"{digest}.json"

    def _read(self, note: Path, name: str) -> Content | None:
        try:
            document = json.loads(read_regular(note))
            sound = document.pop("check") == digest_value(document) and document["path"] == name
            content = document["content"]
        except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return None
        files = content if isinstance(content, dict) else {"file": content}
        safe = sound and all(is_plain_name(file) and is_digest(digest) for file, digest in files.items())
        return content if safe else None


@dataclass(frozen=True)
class ResultGuard:
    """Puts damaged results back as their jobs wrote them.

    Attributes
    ----------
    made : Made
    objects : Objects
        Where they are taken from.
    tell : callable
        Takes a sentence.
    """

    made: Made
    objects: Objects
    tell: Callable[[str], None]

    def settle(self, path: Path, digest: str) -> str:
        """Return the digest of a file as its job wrote it, having put that back if another one was found.

        Raises
        ------
        UserError
            If the store does not hold it any more.
        """
        content = self.made.find(path)
        if not isinstance(content, str) or content == digest:
            return digest
        self._put_back(content, path, "is not what its job wrote")
        return content

    def fill(self, path: Path) -> None:
        """Put back a result, or files of a folder of results, that are missing.

        Raises
        ------
        UserError
            If the store does not hold them any more.
        """
        content = self.made.find(path)
        if isinstance(content, dict):
            for name, digest in content.items():
                if not (path / name).is_file():
                    self._put_back(digest, path / name, "is missing")
        elif content is not None and not path.is_file():
            self._put_back(content, path, "is missing")

    def _put_back(self, digest: str, path: Path, fault: str) -> None:
        try:
            self.objects.check_out(digest, path)
        except DamagedObject:
            raise UserError(
                f"{path}: expected the file that its job wrote, but it {fault}, and the store has no copy of it; "
                f"delete {path.parent if fault == 'is missing' else path} and run again."
            ) from None
        self.tell(f"{path} {fault}; it is taken from the store again")
