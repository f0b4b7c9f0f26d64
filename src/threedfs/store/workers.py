"""Processes that share what is imported: forked, each takes one item after the other."""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from typing import TypeVar, cast

Item = TypeVar("Item")
Answer = TypeVar("Answer")

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""What has libraries whose sums depend on the number of threads use one, and start none that forks would lack."""
FORKED = "THREEDFS_FORKED"
"""A variable of the environment that is set in forks of a process that has imported the libraries."""

_SET_DEATH_SIGNAL = 1  # of Linux's prctl


@dataclass(frozen=True)
class Death:
    """The end of a worker before its answer.

    Attributes
    ----------
    status : int
        Its exit status; that of a signal is negative.
    """

    status: int

    def __str__(self) -> str:
        how = f"was killed by signal {-self.status}" if self.status < 0 else f"ended with status {self.status}"
        return f"the process that worked on it {how}, as when memory runs out; run again with fewer cores."


def share_out(
    work: Callable[[Item], Answer], items: Sequence[Item], count: int
) -> Iterator[tuple[Item, Answer | Death]]:
    """Do work on items in `count` forked processes; yield what each comes to, as it ends.

    A worker that dies is not replaced: the others go on with the items that are left. None outlives this process or
    the iteration. What was imported before is there in every worker; no thread is, so none may be running.

    Parameters
    ----------
    work : callable
        Its answer must be fit to be pickled.
    items : sequence
    count : int
        At most so many processes.
    """
    context = multiprocessing.get_context("fork")
    pending = deque(items)
    workers: dict[Connection, BaseProcess] = {}
    busy: dict[Connection, Item] = {}
    try:
        for _ in range(min(count, len(items))):
            here, there = context.Pipe()
            process = context.Process(target=_serve, args=(there, work, os.getpid()), daemon=True)
            process.start()
            there.close()  # so that the end of the worker is the end of the pipe
            workers[here] = process
            _hand_out(pending, here, busy)
        while busy:
            for ready in wait(list(busy)):
                here = cast(Connection, ready)
                item = busy.pop(here)
                try:
                    answer = here.recv()
                except (EOFError, OSError):
                    workers[here].join()
                    yield item, Death(workers[here].exitcode or 0)
                else:
                    _hand_out(pending, here, busy)
                    yield item, answer
    finally:
        for here, worker in workers.items():
            worker.kill()
            worker.join()
            here.close()


def die_with_parent() -> None:
    """Have this process killed when its parent ends; where Linux lets it."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SET_DEATH_SIGNAL, signal.SIGKILL)


def _hand_out(pending: deque[Item], here: Connection, busy: dict[Connection, Item]) -> None:
    if pending:
        busy[here] = pending.popleft()
        try:
            here.send(busy[here])
        except OSError:  # it has died meanwhile; that is told when its answer is read
            pass


def _serve(there: Connection, work: Callable[[Item], Answer], parent: int) -> None:
    """Answer items until the parent ends this process, or has ended itself."""
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent gets it too, and ends its workers
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    try:
        while os.getppid() == parent:
            if there.poll(1.0):
                there.send(work(there.recv()))
    except (EOFError, BrokenPipeError):
        pass
