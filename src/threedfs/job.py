"""What a stage is given beside its files and parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from threedfs.progress import Progress


@dataclass(frozen=True)
class Job:
    """One run of one stage.

    Attributes
    ----------
    progress : Progress
        Takes notes for the user.
    header : mapping
        Goes into every artifact the stage writes: the parameters and the digest of what it was made from.
    threads : int
        Cores it may use; never changes a result.
    seed : int
        The one seed of the configuration.
    """

    progress: Progress
    header: Mapping[str, Any] = field(default_factory=dict)
    threads: int = 1
    seed: int = 0
