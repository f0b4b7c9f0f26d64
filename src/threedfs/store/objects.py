"""Immutable bytes under the name of their hash."""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

from threedfs.store.digests import InputDigests
from threedfs.store.files import flush_folder, make_folder, open_regular, remove, remove_abandoned, temporary_name
from threedfs.store.records import Content, is_digest, is_plain_name

_BLOCK = 1 << 20  # bytes copied at once


class DamagedObject(Exception):
    """An object is missing, or its bytes do not have the hash that names it."""


class Objects:
    """The objects of a store.

    Parameters
    ----------
    folder : Path
        Holds ``<first two digits>/<sha256>``, read-only files.
    digests : InputDigests or None
        Is told what is checked out, so that the next job need not hash it.
    fallback : Path or None
        Objects of another store, which is only read: those that are missing or damaged here are copied from there.
    """

    def __init__(self, folder: Path, digests: InputDigests | None, fallback: Path | None = None) -> None:
        self.folder = folder
        self.digests = digests
        self.fallback = fallback

    def path(self, digest: str) -> Path:
        """Return where an object lies.

        Raises
        ------
        DamagedObject
            If the name is none of an object: it could lead out of the folder.
        """
        return _object_path(self.folder, digest)

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
                if target.is_dir():
                    remove(target)
            else:
                temporary.mkdir()
                for name, digest in content.items():
                    if not is_plain_name(name):
                        raise DamagedObject(f"a file {name!r} does not lie in its folder")
                    (temporary / name).parent.mkdir(parents=True, exist_ok=True)
                    self._copy(digest, temporary / name)
                remove(target)
            os.replace(temporary, target)
        finally:
            remove(temporary)
        if isinstance(content, str) and self.digests is not None:
            self.digests.remember(target, content)

    def keep_copy(self, digest: str) -> None:
        """Copy an object from the fallback into the store, verified.

        Raises
        ------
        DamagedObject
            If neither has it whole.
        """
        place = self.path(digest)
        make_folder(place.parent)
        temporary = temporary_name(place)
        remove(temporary)
        try:
            self._copy(digest, temporary)
            self._settle(temporary, place)
        finally:
            remove(temporary)

    def has(self, digest: str) -> bool:
        """Say whether there is a file for an object; its bytes are not looked at."""
        path = self.path(digest)
        return path.is_file() and not path.is_symlink()

    def _take_in_file(self, built: Path) -> str:
        with open(built, "rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
            os.fsync(file.fileno())
        place = self.path(digest)
        make_folder(place.parent)
        self._settle(built, place)
        return digest

    def _settle(self, file: Path, place: Path) -> None:
        """Move a file to its place for good, whatever lies there."""
        os.chmod(file, 0o444)
        try:
            os.replace(file, place)
        except IsADirectoryError:
            remove(place)
            os.replace(file, place)
        flush_folder(place.parent)

    def _copy(self, digest: str, target: Path) -> None:
        """Copy an object and verify it on the way; a damaged one is removed, and the fallback's taken."""
        try:
            copy_verified(self.folder, digest, target)
        except DamagedObject as fault:
            place = self.path(digest)
            missing = not os.path.lexists(place)
            if place.is_symlink() or os.access(place, os.R_OK):  # what others may read is not ours to judge
                _remove_if_possible(place)
            if self.fallback is None:
                raise
            try:
                copy_verified(self.fallback, digest, target)
            except DamagedObject as second:
                raise (second if missing else fault) from None


def copy_verified(folder: Path, digest: str, target: Path) -> None:
    """Copy an object from a folder of objects to a new file, and verify it on the way.

    Raises
    ------
    DamagedObject
        If it is missing, damaged, no file, or cannot be read.
    """
    found = hashlib.sha256()
    with open(target, "wb") as copy:
        for block in _read_blocks(_object_path(folder, digest), digest):
            found.update(block)
            copy.write(block)
        copy.flush()
        os.fsync(copy.fileno())
    if found.hexdigest() != digest:
        raise DamagedObject(f"object {digest} is damaged")


def _read_blocks(path: Path, digest: str) -> Iterator[bytes]:
    """Yield the bytes of an object; faults in reading it are told from those in writing its copy."""
    try:
        with open_regular(path) as source:
            while block := source.read(_BLOCK):
                yield block
    except FileNotFoundError:
        raise DamagedObject(f"object {digest} is missing") from None
    except OSError as fault:
        reason = "a link" if fault.errno == errno.ELOOP else fault.strerror
        raise DamagedObject(f"object {digest} is damaged ({reason})") from None


def _object_path(folder: Path, digest: str) -> Path:
    if not is_digest(digest):
        raise DamagedObject(f"{digest!r} names no object")
    return folder / digest[:2] / digest


def _remove_if_possible(place: Path) -> None:
    try:
        remove(place)
    except OSError:  # a store that is only read: its owner is told by the note on the object
        pass
