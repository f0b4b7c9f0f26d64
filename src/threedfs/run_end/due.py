"""Which sequences need another report at the end of a run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from threedfs.run_end.summary import read_summary

_WATCHED = (
    "02_poses/poses.json",
    "11_object/*/mesh.ply",
    "11_object/scale.json",
    "12_evaluate/**/*.csv",
    "**/logs/**/*.log",
)
"""Files of a sequence that its report is older than, if it is out of date."""


def is_due(folder: Path, methods: Sequence[str], complete: bool) -> bool:
    """Say whether a sequence, none of whose jobs failed, needs another report.

    It does if it has newer results, if methods of now are others, and if its report tells of a failure though all
    that the run is to make is there.
    """
    summary = read_summary(folder)
    known = summary is not None and summary.methods == tuple(methods) and not (complete and summary.failures)
    return _is_newer(folder) or ((folder / "report.html").is_file() and not known)


def _is_newer(folder: Path) -> bool:
    """Say whether results of a sequence are newer than its report, or there are some and it has none."""
    page = folder / "report.html"
    made = max((path.stat().st_mtime for pattern in _WATCHED for path in folder.glob(pattern)), default=None)
    return made is not None and (not page.is_file() or page.stat().st_mtime < made)
