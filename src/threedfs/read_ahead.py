"""Items made by other threads while those before them are used."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

Item = TypeVar("Item")
Made = TypeVar("Made")

_END = object()


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
    left = iter(items)
    with ThreadPoolExecutor(1) as pool:
        try:
            ready: deque[Future[Any]] = deque(pool.submit(next, left, _END) for _ in range(count))
            while (item := ready.popleft().result()) is not _END:
                ready.append(pool.submit(next, left, _END))
                yield item
        finally:
            pool.shutdown(cancel_futures=True)


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
