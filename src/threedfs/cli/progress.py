"""How far a run has come and how long it will take, read from what Snakemake and the jobs say."""

from __future__ import annotations

import re
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from statistics import mean
from typing import TextIO

from threedfs.cli.costs import Costs, Size

_TRUST = 5.0
"""Seconds of work that the costs known before weigh as much as, beside the speed seen in the run."""
_EARLIEST = 0.04
"""Share of the work after which the time that is left is told."""
_TAKEN = 0.5
"""Seconds of a job that finds its results in the store."""
_UNCOUNTED = ("all", "collect")

_COUNT = re.compile(r"^(\w+)\s+(\d+)$")
# Snakemake writes the end of this line apart, so what a job says meanwhile comes right behind it
_FINISHED = re.compile(r"^Finished jobid: \d+ \(Rule: (\w+)\)(.*)$")
_SAYS = re.compile(r"^(\w+) of (\S+)[^:]*: (.*)$")
# keyframes of a job that works on each of them, or the frames of a video: the whole of a job, not a phase of it
_PART = re.compile(r"(?:^source frame |\()(\d+)/(\d+)\)?$")
_FRAMES = re.compile(r"^(\d+) of \d+ frames taken")
_KEYFRAMES = re.compile(r"^(\d+) keyframes of")
_FROM_STORE = "taken from the store"


class Progress:
    """Follows the output of a run line by line.

    The time that is left is the cost of the jobs that are left, by their rule and the size of the input, over the speed
    that the run has had so far; jobs that found their results in the store count for neither, and those whose time
    varies with what the images show do not count for the speed.

    Parameters
    ----------
    costs : Costs
    stream : text stream
        Where progress is shown: one line, written over and over, on a terminal; else a line for each tenth of the work.
    journal : text stream, optional
        Gets such lines in any case.
    measure : callable, optional
        Returns the size of a sequence's input by its name, asked after jobs that tell it.
    clock : callable
        Tells the time in seconds.
    """

    def __init__(
        self,
        costs: Costs,
        stream: TextIO = sys.stderr,
        journal: TextIO | None = None,
        measure: Callable[[str], Size] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._costs, self._measure, self._clock = costs, measure, clock
        self._stream, self._live = stream, stream.isatty()
        self._journals = [each for each in (journal, None if self._live else stream) if each]
        self._begun, self._shown, self._told = clock(), 0.0, 0.0
        self._planned: dict[str, int] = {}
        self._worked: dict[str, list[float]] = defaultdict(list)  # of each finished job, the share not from the store
        self._parts: dict[str, dict[str, float]] = defaultdict(dict)  # of jobs under way, by rule and sequence
        self._taken: dict[str, list[bool]] = defaultdict(list)  # of what a rule's jobs have told, what was in the store
        self._sizes: dict[str, Size] = defaultdict(Size)
        self._ended, self._aside = self._begun, 0.0  # when a job ended last; seconds that say nothing of the speed
        self._stage, self._listing = "starting", False

    @property
    def share(self) -> float:
        """Of the work that is done, in [0, 1]."""
        done, left = self._weigh()
        return done / (done + left) if done + left else 0.0

    def left(self) -> float | None:
        """Return the seconds that are left, None while nothing is known of them."""
        done, left = self._weigh()
        if not done or done < _EARLIEST * (done + left):
            return None
        steady, _ = self._weigh(steady=True)
        aside = self._aside + (self._clock() - self._ended if self._costs.varies(self._stage) else 0.0)
        return left * (_TRUST + self.elapsed - aside) / (_TRUST + steady)

    @property
    def elapsed(self) -> float:
        """Seconds since the run began."""
        return self._clock() - self._begun

    def _weigh(self, steady: bool = False) -> tuple[float, float]:
        """Return the cost of what is done and of what is left, seconds at the speed of the costs known before.

        Steady: of jobs alone whose time tells the speed.
        """
        done = left = 0.0
        size = self._size()
        for rule, count in self._planned.items():
            if steady and self._costs.varies(rule):
                continue
            worked = self._worked[rule]
            each = self._costs.expect(rule, max(count, len(worked)), size)
            done += sum(max(_TAKEN, cost * own) for cost, own in zip(each, worked, strict=False))
            ahead = each[len(worked) :]
            parts = sorted(self._parts[rule].values(), reverse=True)[: len(ahead)]
            begun = sum(cost * part for cost, part in zip(ahead, parts, strict=False))
            done, left = done + begun, left + sum(ahead) - begun
        return done, left

    def _size(self) -> Size:
        """Return what is known of the sequences, in the mean."""
        known = {name: [getattr(size, name) for size in self._sizes.values()] for name in Size.__dataclass_fields__}
        present = {name: [value for value in values if value] for name, values in known.items()}
        return Size(**{name: mean(values) for name, values in present.items() if values})

    def follow(self, line: str) -> None:
        """Take one line of the run's output."""
        if line.startswith("Job stats:"):
            self._listing, self._planned = True, {}
            self._worked.clear()
        elif self._listing and (match := _COUNT.match(line)):
            if match[1] == "total":
                self._listing = False
            elif match[1] not in _UNCOUNTED:
                self._planned[match[1]] = int(match[2])
        elif match := _FINISHED.match(line):
            self._finish(match[1])
            line = match[2]
        if match := _SAYS.match(line):
            self._listen(*match.groups())
        self.show()

    def _finish(self, rule: str) -> None:
        told = self._taken.pop(rule, [])
        if rule in self._planned:
            self._worked[rule].append(1 - sum(told) / len(told) if told else 1.0)
        now = self._clock()
        if self._costs.varies(rule):
            self._aside += now - self._ended
        self._ended = now
        if parts := self._parts[rule]:
            del parts[max(parts, key=lambda part: parts[part])]

    def _listen(self, stage: str, sequence: str, message: str) -> None:
        """Take what a job says of itself."""
        self._stage = stage
        size = self._sizes[sequence]
        if match := _FRAMES.match(message):
            self._sizes[sequence] = replace(size, frames=float(match[1]))
        elif match := _KEYFRAMES.match(message):
            self._sizes[sequence] = replace(size, keyframes=float(match[1]))
        if match := _PART.search(message):
            self._parts[stage][sequence] = min(1.0, int(match[1]) / max(1, int(match[2])))
        if message.startswith((_FROM_STORE, "done in")):
            self._taken[stage].append(message.startswith(_FROM_STORE))
            if stage == "crops" and self._measure:
                measured = {name: value for name, value in vars(self._measure(sequence)).items() if value}
                self._sizes[sequence] = replace(self._sizes[sequence], **measured)

    def show(self, last: bool = False) -> None:
        """Show how far the run has come, if it is time to."""
        now, share = self._clock(), self.share
        if self._live and (last or now - self._shown > 0.5):
            self._shown = now
            self._stream.write(f"\r\033[K{self._describe()}" + ("\n" if last else ""))
            self._stream.flush()
        if not last and share >= self._told + 0.1:
            self._told = share
            for journal in self._journals:
                journal.write(f"{self._describe()}\n")
                journal.flush()

    def _describe(self) -> str:
        left = self.left()
        rest = "" if left is None else f", about {tell_time(left)} left"
        return f"{self.share:4.0%}  {tell_time(self.elapsed)}{rest}  {self._stage}"


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
