"""Immutable bytes under the name of their hash."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

from threedfs.store.digests import InputDigests
from threedfs.store.files import flush_folder, remove, remove_abandoned, temporary_name

_BLOCK = 1 << 20  # bytes copied at once

Content = str | dict[str, str]
"""What an output holds: the digest of a file, or digests by relative name of the files of a folder."""


class DamagedObject(Exception):
    """An object is missing, or its bytes do not have the hash that names it."""


class Objects:
    """The objects of a store.

    Parameters
    ----------
    folder : Path
        Holds ``<first two digits>/<sha256>``, read-only files.
    digests : InputDigests
        Is told what is checked out, so that the next job need not hash it.
    """

    def __init__(self, folder: Path, digests: InputDigests) -> None:
        self.folder = folder
        self.digests = digests

    def path(self, digest: str) -> Path:
        """Return where an object lies."""
        return self.folder / digest[:2] / digest

    def take_in(self, built: Path) -> Content:
        """Move a file, or every file of a folder, into the store, and return its digests.

        The file must lie on the store's own file system; it is gone afterwards.
        """
        if built.is_dir():
            files = sorted(file for file in built.rglob("*") if file.is_file())
            return {file.relative_to(built).as_posix(): self._take_in_file(file) for file in files}
        return self._take_in_file(built)

    def check_out(self, content: Content, target: Path) -> None:
        """Put an output in its place, verified; it appears under its name only when it is whole.

        Raises
        ------
        DamagedObject
            If an object is missing or damaged; a damaged one is removed from the store.
        """
        target.parent.mkdir(parents=True, exist_ok=True)
        remove_abandoned(target.parent, target.name)
        temporary = temporary_name(target)
        remove(temporary)
        try:
            if isinstance(content, str):
                self._copy(content, temporary)
            else:
                temporary.mkdir()
                for name, digest in content.items():
                    (temporary / name).parent.mkdir(parents=True, exist_ok=True)
                    self._copy(digest, temporary / name)
                remove(target)
            os.replace(temporary, target)
        finally:
            remove(temporary)
        if isinstance(content, str):
            self.digests.remember(target, content)

    def _take_in_file(self, built: Path) -> str:
        with open(built, "rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            os.fsync(file.fileno())
        place = self.path(digest)
        place.parent.mkdir(parents=True, exist_ok=True)
        os.chmod(built, 0o444)
        os.replace(built, place)
        flush_folder(place.parent)
        return digest

    def _copy(self, digest: str, target: Path) -> None:
        """Copy an object and verify it on the way."""
        found = hashlib.sha256()
        try:
            with open(self.path(digest), "rb") as source, open(target, "wb") as copy:
                while block := source.read(_BLOCK):
                    found.update(block)
                    copy.write(block)
                copy.flush()
                os.fsync(copy.fileno())
        except FileNotFoundError:
            raise DamagedObject(f"object {digest} is missing") from None
        if found.hexdigest() != digest:
            self.path(digest).unlink(missing_ok=True)
            raise DamagedObject(f"object {digest} is damaged")
