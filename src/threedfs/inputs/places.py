"""Where a run writes: whether it can."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from threedfs.errors import UserError

_LEAST_FREE = 100_000_000


def check_places(store: Path, results: Path, names: Iterable[str] = ()) -> None:
    """Check that store and results can be written to, without writing.

    Parameters
    ----------
    store, results : Path
        Folders, that need not be there yet.
    names : iterable of str
        Of folders in the results.

    Raises
    ------
    UserError
        If a file is where a folder is to be, a folder is read-only, or the disk is full.
    """
    _check_folder(results, "results", "run in another folder")
    _check_folder(store, "store", "name another folder by store in the configuration")
    for name in names:
        _check_folder(results / name, "results", "move it away")


def _check_folder(folder: Path, what: str, advice: str) -> None:
    for place in (folder, *folder.parents):
        if os.path.lexists(place) and not place.is_dir():
            raise UserError(f"{what}: expected a folder to write to, found a file at {place}; {advice}.")
        if place.is_dir():
            break
    if not os.access(place, os.W_OK | os.X_OK):
        raise UserError(f"{what}: expected a folder to write to, but {place} is read-only; {advice}.")
    free = shutil.disk_usage(place).free
    if free < _LEAST_FREE:
        raise UserError(
            f"{what}: expected room to write to, but the disk of {place} has {free / 1e6:.0f} MB left; free some, or "
            f"{advice}."
        )
