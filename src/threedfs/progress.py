"""What a long job tells while it works."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator, Sized
from typing import Protocol, TypeVar

Item = TypeVar("Item")


class Stream(Protocol):
    """What takes lines."""

    def write(self, text: str, /) -> object:
        """Take text."""

    def flush(self) -> object:
        """Hand on what was taken."""


class Progress:
    """Writes notes and rate-limited counts to a log.

    Parameters
    ----------
    stage : str
        Put before each line.
    stream : file, optional
        Where lines go; standard error without one.
    interval : float
        Least time between two counts, in seconds.
    """

    def __init__(self, stage: str, stream: Stream | None = None, interval: float = 2.0) -> None:
        self.stage = stage
        self.stream: Stream = stream if stream is not None else sys.stderr
        self.interval = interval

    def note(self, message: str) -> None:
        """Write one line."""
        print(f"{self.stage}: {message}", file=self.stream, flush=True)

    def track(self, items: Iterable[Item], what: str, total: int | None = None) -> Iterator[Item]:
        """Yield the items, writing "what i/total" now and then."""
        if total is None and isinstance(items, Sized):
            total = len(items)
        last = time.monotonic()
        for count, item in enumerate(items, start=1):
            yield item
            if time.monotonic() - last >= self.interval:
                last = time.monotonic()
                self.note(f"{what} {count}" + (f"/{total}" if total else ""))
