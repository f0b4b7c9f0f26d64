"""What kind of artifact a file is; each module of artifacts names its own, so that a new one touches no other."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from threedfs.errors import UserError


@dataclass(frozen=True)
class Schema:
    """A kind of artifact: its name and version, and the rules that write it, as a sentence has them."""

    name: str
    rules: str


KEYFRAMES = Schema("threedfs/keyframes/1", "keyframes, crops or shrink")
"""Here, because the store looks into keyframes too, and loads no numeric library for it."""


def check_schema(path: Path, found: str | None, expected: Schema) -> None:
    """Raise a UserError unless the schema found in a file is the one expected."""
    if found != expected.name:
        raise UserError(
            f"{path}: expected schema {expected.name}, got {found}; delete the file and run again, "
            f"rule {expected.rules} writes it."
        )
