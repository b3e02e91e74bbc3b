"""Ctrl+C, SIGTERM and SIGHUP unwind a command: no temporary file stays, and the processes it started end with it."""

import contextlib
import signal
import threading
import time
from collections.abc import Iterator
from types import FrameType

from frontal_biped.exceptions import Interruption
from frontal_biped.files.signals import SIGNALS

ECHO = 1.0
"""A signal within this time of the first leaves the unwinding alone [s]; a later one interrupts that as well."""


@contextlib.contextmanager
def interruptible(to_the_end: bool) -> Iterator[None]:
    """Signals raise `Interruption` inside the block.

    Where a signal is ignored, as SIGHUP is under nohup, or handled by somebody else, it stays so; outside the main
    thread, which alone may handle signals, nothing is changed.

    Args:
        to_the_end: after the block the process ends: a signal then ends it at once, without a traceback. Otherwise the
            handlers of before come back.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    first: float | None = None

    def on_signal(number: int, _: FrameType | None) -> None:
        nonlocal first
        now = time.monotonic()
        if first is not None and now - first < ECHO:
            return
        first = now if first is None else first
        raise Interruption(number)

    free = (signal.SIG_DFL, signal.default_int_handler)
    before = {number: signal.getsignal(number) for number in SIGNALS}
    before = {number: handler for number, handler in before.items() if handler in free}
    try:
        for number in before:
            signal.signal(number, on_signal)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if to_the_end else handler)
