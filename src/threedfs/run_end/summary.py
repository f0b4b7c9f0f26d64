"""What a page over several sequences says of each: written beside its report, so that no mesh is read for it again."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from threedfs.io.atomic import atomic

_NAME = "report.json"


@dataclass(frozen=True)
class Summary:
    """A sequence in short.

    Attributes
    ----------
    methods : tuple of str
        Those of the run that it was made by; others that lie in the folder are of earlier runs.
    method : str
        Whose mesh is shown, empty without any.
    verdict : str
        One sentence; empty where there was nothing to judge.
    good : bool, optional
        Whether all checks passed; None where there was nothing to judge.
    failures : tuple of str
        Sentences of the jobs that failed.
    picture : str
        Address of a small image inside of a page, empty without any.
    """

    methods: tuple[str, ...] = ()
    method: str = ""
    verdict: str = ""
    good: bool | None = None
    failures: tuple[str, ...] = ()
    picture: str = ""


def write_summary(folder: Path, summary: Summary) -> None:
    """Write the summary of a sequence into the folder of its results."""
    with atomic(folder / _NAME) as temporary:
        temporary.write_text(json.dumps(asdict(summary), indent=1) + "\n", encoding="utf-8")


def read_summary(folder: Path) -> Summary | None:
    """Read the summary of a sequence; None if there is none, or it is damaged or of another version."""
    try:
        content = json.loads((folder / _NAME).read_text(encoding="utf-8"))
        values: dict[str, Any] = {
            key: tuple(value) if isinstance(value, list) else value for key, value in content.items()
        }
        return Summary(**values)
    except (OSError, ValueError, TypeError, AttributeError):
        return None
