"""How far a run has come, read from what Snakemake and the jobs say."""

from __future__ import annotations

import re
import sys
import time
from collections.abc import Mapping
from typing import TextIO

_NORMAL = {
    "frames": (6,),
    "features": (7,),
    "poses": (16,),
    "keyframes": (2,),
    "shrink": (4,),
    "scout": (5,),
    "depth": (10, 50),
    "consistency": (4, 13),
    "fuse_scene": (5,),
    "locate": (15,),
    "crops": (10,),
    "cues": (17,),
    "fuse_object": (8,),
    "locate_object": (2,),
    "segment": (20,),
    "cut_object": (6,),
    "pixel_masks": (6,),
    "surface": (31,),
    "texture": (10,),
    "photographs": (5,),
    "evaluate": (3,),
    "evaluate_reconstruction": (2,),
}
"""Seconds of a rule's first, second, ... job on a phone video with 24 keyframes, on two cores; shares alone count."""
_DRAFT = {
    **{"frames": (5,), "features": (5,), "poses": (14,), "shrink": (3,), "scout": (4,), "depth": (5, 6)},
    **{"consistency": (3,), "fuse_scene": (3,), "locate": (5,), "crops": (6.5,), "cues": (4,), "fuse_object": (3,)},
    **{"segment": (8,), "pixel_masks": (5,), "surface": (9,), "texture": (4,), "photographs": (3,), "evaluate": (2.5,)},
}
SECONDS = {"draft": {**_NORMAL, **_DRAFT}, "normal": _NORMAL, "fine": _NORMAL}
"""The same by quality."""
_OTHER = 5.0
_EARLIEST = 0.04
"""Share of the work after which the time that is left is told."""

_COUNT = re.compile(r"^(\w+)\s+(\d+)$")
_FINISHED = re.compile(r"^Finished jobid: \d+ \(Rule: (\w+)\)")
_SAYS = re.compile(r"^(\w+) of (\S+)[^:]*: (.*)$")
_PART = re.compile(r"(\d+)/(\d+)\)?$")


class Progress:
    """Follows the output of a run line by line.

    Parameters
    ----------
    seconds : mapping of str to tuple of float
        Of each rule's jobs, as in `SECONDS`.
    stream : text stream
        Where progress is shown: one line, written over and over, on a terminal; else a line for each tenth.
    """

    def __init__(self, seconds: Mapping[str, tuple[float, ...]], stream: TextIO = sys.stderr) -> None:
        self._seconds = seconds
        self._stream, self._live = stream, stream.isatty()
        self._begun, self._shown, self._told = time.monotonic(), 0.0, 0.0
        self._left: dict[str, list[float]] = {}
        self._all = self._done = self._part = 0.0
        self._stage, self._listing = "starting", False

    @property
    def share(self) -> float:
        """Of the work that is done, in [0, 1]."""
        return min(1.0, (self._done + self._part) / self._all) if self._all else 0.0

    def left(self) -> float | None:
        """Return the seconds that are left, None while nothing is known of them."""
        share = self.share
        return None if share < _EARLIEST else (time.monotonic() - self._begun) * (1 - share) / share

    def follow(self, line: str) -> None:
        """Take one line of the run's output."""
        if line.startswith("Job stats:"):
            self._listing, self._left, self._all, self._done = True, {}, 0.0, 0.0
        elif self._listing and (match := _COUNT.match(line)):
            self._expect(match[1], int(match[2]))
        elif match := _FINISHED.match(line):
            left = self._left.get(match[1])
            self._done += left.pop(0) if left else 0.0
            self._part = 0.0
        elif match := _SAYS.match(line):
            self._stage = match[1]
            part = _PART.search(match[3])
            left = self._left.get(match[1])
            if part and left and int(part[2]):
                self._part = left[0] * min(1.0, int(part[1]) / int(part[2]))
        self.show()

    def _expect(self, rule: str, count: int) -> None:
        if rule == "total":
            self._listing = False
        elif rule not in ("all", "collect"):
            each = self._seconds.get(rule, (_OTHER,))
            self._left[rule] = [float(each[min(rank * len(each) // count, len(each) - 1)]) for rank in range(count)]
            self._all += sum(self._left[rule])

    def show(self, last: bool = False) -> None:
        """Show how far the run has come, if it is time to."""
        now, share = time.monotonic(), self.share
        if self._live and (last or now - self._shown > 0.5):
            self._shown = now
            self._stream.write(f"\r\033[K{self._describe()}" + ("\n" if last else ""))
            self._stream.flush()
        elif not self._live and not last and share >= self._told + 0.1:
            self._told = share
            self._stream.write(f"{self._describe()}\n")
            self._stream.flush()

    def _describe(self) -> str:
        left = self.left()
        rest = "" if left is None else f", about {tell_time(left)} left"
        return f"{self.share:4.0%}  {tell_time(time.monotonic() - self._begun)}{rest}  {self._stage}"


def tell_time(seconds: float) -> str:
    """Return a time as minutes and seconds.

    Examples
    --------
    >>> tell_time(75), tell_time(3675)
    ('1:15', '1:01:15')
    """
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
