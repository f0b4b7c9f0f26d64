"""Exact: items made ahead are the same items, in the same order, with the same faults."""

import threading
import time

import pytest

from threedfs.read_ahead import map_ahead, read_ahead


@pytest.mark.parametrize("threads", [1, 2, 5])
@pytest.mark.parametrize("count", [1, 4, 100])
def test_items_come_in_their_order(threads, count):
    assert list(read_ahead(iter(range(50)), threads=threads, count=count)) == list(range(50))
    assert list(read_ahead([], threads=threads, count=count)) == []


@pytest.mark.parametrize("threads", [1, 2])
def test_a_fault_comes_after_the_items_before_it(threads):
    def faulty():
        yield from range(3)
        raise ValueError("the fourth")

    seen = []
    with pytest.raises(ValueError, match="the fourth"):
        for item in read_ahead(faulty(), threads=threads):
            seen.append(item)
    assert seen == [0, 1, 2]


def test_no_more_are_made_than_asked_for():
    made = []

    def items():
        for item in range(100):
            made.append(item)
            yield item

    ahead = read_ahead(items(), threads=2, count=3)
    assert next(ahead) == 0
    time.sleep(0.3)
    assert len(made) <= 1 + 3 + 1 + 1  # given, ready, in the hand of the thread, and the next


def test_the_thread_ends_when_the_items_are_given_up():
    before = threading.active_count()
    ahead = read_ahead(iter(range(1000)), threads=2)
    assert next(ahead) == 0
    ahead.close()
    assert threading.active_count() == before


def test_the_next_item_is_made_while_one_is_used():
    second = threading.Event()

    def items():
        yield 0
        second.set()
        yield 1

    ahead = read_ahead(items(), threads=2)
    assert next(ahead) == 0
    assert second.wait(60)
    assert list(ahead) == [1]


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_what_is_made_of_items_comes_in_their_order(threads):
    assert list(map_ahead(lambda item: item**2, range(50), threads=threads)) == [item**2 for item in range(50)]
    assert list(map_ahead(str, [], threads=threads)) == []


@pytest.mark.parametrize("threads", [1, 2])
def test_a_fault_in_making_comes_in_its_place(threads):
    seen = []
    with pytest.raises(ZeroDivisionError):
        for made in map_ahead(lambda item: 6 // (3 - item), range(10), threads=threads):
            seen.append(made)
    assert seen == [2, 3, 6]


def test_no_more_items_are_taken_than_threads_can_hold():
    taken = []
    ahead = map_ahead(lambda item: item, (taken.append(item) or item for item in range(100)), threads=2)
    assert next(ahead) == 0
    assert len(taken) == 3
    ahead.close()
    assert len(taken) == 3


def test_threads_make_at_the_same_time():
    both = threading.Barrier(2, timeout=60)
    assert len(list(map_ahead(lambda _: both.wait(), range(4), threads=2))) == 4
