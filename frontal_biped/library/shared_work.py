"""Work that this process and others share: they take it from the front, and what is left at last is done here.

An executor takes hold of the next calls while it is still busy, and what it has taken cannot be had back; here it is
given no more than it can begin at once.
"""

import contextlib
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, Generic, TypeVar

T = TypeVar("T")


class Part(Generic[T]):
    """A part of the work: a call, and what comes of it."""

    def __init__(self, function: Callable[..., T], *arguments: Any) -> None:
        self.function, self.arguments = function, arguments
        self.future: Future[T] = Future()

    def result(self) -> T:
        """What came of it, waited for; raises what the call raised."""
        return self.future.result()


class SharedWork:
    """Parts of some work, the longest best added first.

    Args:
        executor: of other processes.
        processes: how many it has.
    """

    def __init__(self, executor: Executor, processes: int) -> None:
        self._executor, self._idle = executor, processes
        self._waiting: deque[Part[Any]] = deque()
        self._lock = threading.Lock()

    def add(self, function: Callable[..., T], *arguments: Any) -> Part[T]:
        """Add a part; it begins at once if a process is idle."""
        part = Part(function, *arguments)
        with self._lock:
            self._waiting.append(part)
        self._hand_out()
        return part

    def do_the_rest(self) -> None:
        """Do here, the last one first, what no other process has begun; what a call raises is told by its part."""
        while True:
            with self._lock:
                if not self._waiting:
                    return
                part = self._waiting.pop()
            try:
                part.future.set_result(part.function(*part.arguments))
            except Exception as error:
                part.future.set_exception(error)

    def _hand_out(self) -> None:
        with self._lock:
            if not (self._idle and self._waiting):
                return
            self._idle -= 1
            part = self._waiting.popleft()
        self._executor.submit(part.function, *part.arguments).add_done_callback(lambda done: self._hand_in(part, done))

    def _hand_in(self, part: Part[Any], done: "Future[Any]") -> None:
        """In the executor's thread: pass on what came of a part, and hand out the next one."""
        with self._lock:
            self._idle += 1
        error = None if done.cancelled() else done.exception()
        if done.cancelled():
            part.future.cancel()
        elif error is not None:
            part.future.set_exception(error)
        else:
            part.future.set_result(done.result())
        with contextlib.suppress(RuntimeError):  # the executor has been shut down: nobody asks any more
            self._hand_out()
