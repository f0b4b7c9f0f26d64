"""Where the workflow lies: in the clone, or where the package was installed."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path

from threedfs.errors import UserError


def find_home() -> Path:
    """Return the folder that holds the Snakefile, config/ and profiles/.

    Raises
    ------
    UserError
        If the package was installed without them.
    """
    clone = Path(__file__).resolve().parents[3]
    if (clone / "Snakefile").is_file():
        return clone
    try:
        files = metadata.files("threedfs") or []
    except metadata.PackageNotFoundError:
        files = []
    for file in files:
        if file.name == "Snakefile":
            return Path(str(file.locate())).resolve().parent
    raise UserError("threedfs: expected its Snakefile beside the package, found none; install it again.")
