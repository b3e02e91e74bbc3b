"""Signals that ask for the end; in a conversation with another process they wait for a pause in it."""

import contextlib
import signal
import threading
import time
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""What asks a process to end: Ctrl+C, a system that shuts down, a terminal that is closed."""

LONGEST_WAIT = 2.0
"""A signal this long after one that waits breaks in after all [s]: the other process may not answer any more."""

_waiting: list[Callable[[], Any]] = []
"""Handlers that are still to be called."""


@contextlib.contextmanager
def signals_wait() -> Iterator[None]:
    """Inside the block a signal whose handler is a Python function waits for `serve_signals`, or the block's end."""
    if threading.current_thread() is not threading.main_thread():  # which alone handles signals
        yield
        return
    handlers = {number: signal.getsignal(number) for number in SIGNALS}
    handlers = {number: handler for number, handler in handlers.items() if callable(handler)}
    first: float | None = None

    def on_signal(number: int, frame: FrameType | None) -> None:
        nonlocal first
        handler: Any = handlers[signal.Signals(number)]
        now = time.monotonic()
        if first is not None and now - first > LONGEST_WAIT:
            handler(number, frame)
        first = now if first is None else first
        _waiting[:] = [lambda: handler(number, None)]

    try:
        for number in handlers:
            signal.signal(number, on_signal)
        yield
    finally:
        for number, handler in handlers.items():
            signal.signal(number, handler)
        serve_signals()


def serve_signals() -> None:
    """A pause in the conversation: what waits is done now."""
    waiting, _waiting[:] = list(_waiting), []
    for call in waiting:
        call()
