"""Items made by a thread of their own while those before them are used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from queue import Full, Queue
from threading import Event, Thread
from typing import TypeVar

Item = TypeVar("Item")

_ITEM, _FAULT, _END = range(3)


def read_ahead(items: Iterable[Item], *, threads: int, count: int = 4) -> Iterator[Item]:
    """Yield items in their order, of which a second thread makes up to `count` before they are asked for.

    What making them takes is hidden where it or their use is work of libraries that leave the interpreter free.

    Parameters
    ----------
    items : iterable
        Run through once, by the other thread alone.
    threads : int
        Those of the job; with one, items are made when they are asked for.
    count : int

    Raises
    ------
    Exception
        What the items raise, in its place among them.
    """
    if threads < 2:
        yield from items
        return
    ready: Queue = Queue(count)
    given_up = Event()

    def hand(kind: int, value: object) -> None:
        while not given_up.is_set():
            try:
                ready.put((kind, value), timeout=0.1)
                return
            except Full:
                pass

    def make() -> None:
        try:
            for item in items:
                hand(_ITEM, item)
                if given_up.is_set():
                    return
        except BaseException as fault:  # raised where the items are used
            hand(_FAULT, fault)
        else:
            hand(_END, None)

    maker = Thread(target=make, daemon=True)
    maker.start()
    try:
        while True:
            kind, value = ready.get()
            if kind == _END:
                return
            if kind == _FAULT:
                raise value
            yield value
    finally:
        given_up.set()
        maker.join()
