"""Parameters of the object stage."""

from __future__ import annotations

from dataclasses import dataclass

from threedfs.params.component import StandingSettings


@dataclass(frozen=True)
class ObjectParams(StandingSettings):
    """How the object is told from the rest of its grid."""
