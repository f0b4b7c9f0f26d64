"""Items made by other threads while those before them are used."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from queue import Full, Queue
from threading import Event, Thread
from typing import TypeVar

Item = TypeVar("Item")
Made = TypeVar("Made")

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


def map_ahead(make: Callable[[Item], Made], items: Iterable[Item], *, threads: int) -> Iterator[Made]:
    """Yield what is made of each item, in their order, by several threads, a few items ahead of their use.

    Parameters
    ----------
    make : callable
        Best one whose work leaves the interpreter free. With one thread it is called when its result is asked for.
    items : iterable
        Run through once, by the thread that asks.
    threads : int
        Changes no result.

    Raises
    ------
    Exception
        What making one raises, in its place among the others.
    """
    if threads < 2:
        yield from map(make, items)
        return
    with ThreadPoolExecutor(threads) as pool:
        making: deque = deque()
        try:
            for item in items:
                making.append(pool.submit(make, item))
                if len(making) > threads:
                    yield making.popleft().result()
            while making:
                yield making.popleft().result()
        finally:
            pool.shutdown(cancel_futures=True)
