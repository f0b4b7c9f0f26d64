"""A run that was killed must not lock out the next one."""

from __future__ import annotations

import fcntl
import os
import time
from pathlib import Path
from typing import TextIO

from threedfs.store.files import remove


def take_over(folder: Path, patience: float = 5.0) -> TextIO | None:
    """Claim a workflow's folder for this process, and clear the locks that a killed run left there.

    Snakemake's locks are files, which outlive a killed run. Beside them this process holds a lock of the operating
    system, which does not: whoever gets it knows that no other run is alive.

    Parameters
    ----------
    folder : Path
        Snakemake's own folder in the working directory.
    patience : float
        Seconds to wait for another process that may be about to end.

    Returns
    -------
    file or None
        To be kept open for as long as the process runs; None if another run is alive, whose locks then stay.
    """
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / "run.lock"
    if os.path.lexists(place) and (place.is_symlink() or not place.is_file()):
        remove(place)  # a pipe would be waited on for ever
    file = open(place, "w")
    end = time.monotonic() + patience
    while True:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            if time.monotonic() >= end:
                file.close()
                return None
            time.sleep(0.1)
        else:
            for lock in (folder / "locks").glob("*.lock"):
                lock.unlink(missing_ok=True)
            return file
