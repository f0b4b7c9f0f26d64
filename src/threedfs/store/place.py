"""Where finished work is kept, and what is said where it cannot be."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from threedfs.errors import UserError
from threedfs.progress import Progress
from threedfs.store.digests import InputDigests
from threedfs.store.made import Made, ResultGuard
from threedfs.store.objects import Objects

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
_FORBIDDEN = (errno.EACCES, errno.EPERM)


@dataclass(frozen=True)
class Store:
    """Where finished work is kept.

    Attributes
    ----------
    folder : Path
    fallback : Path or None
        Another store, which is only read: what this one has not is copied from there.
    made : Path or None
        Folder of notes of what was put into results; without it they are taken as they are.
    """

    folder: Path
    fallback: Path | None = None
    made: Path | None = None

    def digests(self, progress: Progress, thorough: bool = False) -> InputDigests:
        """Return the digests of inputs, which puts damaged results back.

        Parameters
        ----------
        progress : Progress
        thorough : bool
            Look at the bytes of files that have not been touched, too.
        """
        guard = None
        if self.made is not None:
            guard = ResultGuard(Made(self.made), self.objects, progress.note)
        return InputDigests(self.folder / "digests", guard, thorough)

    @property
    def objects(self) -> Objects:
        """What outputs are kept as."""
        fallback = self.fallback / "objects" if self.fallback else None
        return Objects(self.folder / "objects", InputDigests(self.folder / "digests"), fallback)

    @property
    def claims(self) -> Path:
        """Where jobs tell what they are doing."""
        return self.folder / "claims"


@contextmanager
def explained(store: Path) -> Iterator[None]:
    """Turn a full disk, or a store that cannot be written to, into one sentence.

    Raises
    ------
    UserError
    """
    try:
        yield
    except OSError as fault:
        place, root = Path(fault.filename or store).absolute(), store.absolute()
        of_store = place == root or root in place.parents or place in root.parents
        if fault.errno in _FULL or (fault.errno in _FORBIDDEN and of_store):
            raise UserError(
                f"{fault.filename or store}: expected to write finished work to the store {store}, got: "
                f"{fault.strerror}; free space, or name another folder as `store`. "
                "What was finished before is still good."
            ) from None
        raise
