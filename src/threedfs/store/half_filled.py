"""Folders of results that a killed run has left half filled."""

from __future__ import annotations

from base64 import urlsafe_b64decode
from pathlib import Path

from threedfs.store.files import remove


def remove_half_filled(folder: Path, results: Path) -> None:
    """Remove the folders that jobs of a killed run were filling: what was finished of them is in the store.

    Snakemake marks what a job is making, and makes it again if the mark outlives the job. It looks for marks before
    it looks behind checkpoints (as of 9.27): a folder that only a keyframe's stereo wants passed for a whole one.
    A file is left alone: results appear under their names only when they are whole.

    Parameters
    ----------
    folder : Path
        Snakemake's own folder in the working directory.
    results : Path
        Nothing outside of it is removed.
    """
    marks = folder / "incomplete"
    for mark in (path for path in marks.rglob("*") if path.is_file()):
        name = "".join(part.removeprefix("@") for part in mark.relative_to(marks).parts)
        try:
            made = Path(urlsafe_b64decode(name).decode())
        except ValueError:  # a name that Snakemake did not make
            continue
        inside = results in made.parents and ".." not in made.parts
        if inside and made.is_dir() and not made.is_symlink():
            remove(made)
