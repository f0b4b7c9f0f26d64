"""Whether what a sequence is given can be used at all, found out before any work is done."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from threedfs.errors import UserError
from threedfs.inputs.memory import remember
from threedfs.params.sequences import SEQUENCE_FILES
from threedfs.store.code import digest_code

_LOOK = "threedfs.inputs.look"


def find_fault(entry: Mapping[str, Any], frames: Mapping[str, Any], memory: Path) -> tuple[str, tuple[str, ...]]:
    """Look at the files of a sequence.

    Parameters
    ----------
    entry : mapping
        A sequence, as `list_sequences` gives it, whose files are there.
    frames : mapping
        Its settings of the stage `frames`.
    memory : Path
        Folder that remembers what was looked at.

    Returns
    -------
    fault : str
        Why the sequence cannot be used, empty if nothing speaks against it.
    notes : tuple of str
        What looks odd and can be used.
    """
    paths = [Path(entry[key]) for key in SEQUENCE_FILES if entry[key] is not None]
    given = [{key: entry[key] for key in entry if key != "settings"}, dict(frames), digest_code(_LOOK).digest]

    def look_at_files() -> list[str]:
        # what reads images and meshes takes a second to import, which a second run is spared
        from threedfs.inputs.look import look

        return look(entry, frames)

    for path in paths:
        date = path.stat().st_mtime
        if date > time.time():
            day = time.strftime("%Y-%m-%d %H:%M", time.localtime(date))
            return f"{path}: expected a file of the past, got one of {day}; give it a new date, as by touch.", ()
    try:
        return "", remember(memory, paths, given, look_at_files)
    except UserError as fault:
        return str(fault), ()
    except OSError as fault:
        reason = fault.strerror or type(fault).__name__
        return f"{fault.filename or paths[0]}: expected a file that can be read, got {reason}; check the file.", ()
