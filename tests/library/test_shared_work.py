"""Work shared between this process and others: what is done where, and what is told of errors."""

import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from functools import partial

import pytest

from frontal_biped.library.shared_work import SharedWork


class Watched(Executor):
    """Holds what it is given until it is told to do it."""

    def __init__(self):
        self.given = []

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        self.given.append((future, partial(fn, *args, **kwargs)))
        return future

    def do(self):
        future, call = self.given.pop(0)
        try:
            future.set_result(call())
        except ValueError as error:
            future.set_exception(error)


def test_no_more_is_handed_out_than_can_begin_and_the_rest_is_done_here():
    executor = Watched()
    work = SharedWork(executor, 2)
    parts = [work.add(pow, k, 2) for k in range(6)]
    assert len(executor.given) == 2
    executor.do()
    assert len(executor.given) == 2
    work.do_the_rest()
    assert [part.future.done() for part in parts] == [True, False, False, True, True, True]
    executor.do()
    executor.do()
    assert not executor.given
    assert [part.result() for part in parts] == [0, 1, 4, 9, 16, 25]


def test_what_is_left_is_done_from_the_end():
    order = []
    work = SharedWork(Watched(), 1)
    for k in range(4):
        work.add(order.append, k)
    work.do_the_rest()
    assert order == [3, 2, 1]


def test_every_part_is_done_once_whoever_comes_first():
    done = []
    with ThreadPoolExecutor(3) as executor:
        work = SharedWork(executor, 3)
        parts = [work.add(lambda k=k: done.append(k) or k) for k in range(300)]
        work.do_the_rest()
        assert [part.result() for part in parts] == list(range(300))
    assert sorted(done) == list(range(300))


def test_an_error_is_told_by_its_own_part_alone():
    def fails():
        raise ValueError("no")

    executor = Watched()
    work = SharedWork(executor, 1)
    there, here, good = work.add(fails), work.add(fails), work.add(pow, 2, 3)
    work.do_the_rest()
    executor.do()
    assert good.result() == 8
    for part in (there, here):
        with pytest.raises(ValueError, match="no"):
            part.result()


def test_an_executor_that_has_been_shut_down_is_given_nothing_more(caplog):
    executor = ThreadPoolExecutor(1)
    work, hold = SharedWork(executor, 1), threading.Event()
    first, left = work.add(hold.wait), work.add(pow, 2, 3)
    executor.shutdown(wait=False)
    hold.set()
    assert first.result()
    executor.shutdown()
    assert not left.future.done()
    assert not caplog.records
