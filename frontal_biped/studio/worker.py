"""A process that works for the newest request only.

Python threads share one interpreter lock, and a design keeps it busy: the browser would stutter. So a job runs in a
process of its own. A newer request interrupts the job that runs, by a signal, in whatever it is doing; what the
process sends about older requests is dropped. It ends with its parent, however that ends: its pipe then closes.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from frontal_biped.exceptions import FrontalBipedError

Job = Callable[..., Any]
"""A function of a module: ``job(tell, *arguments)`` returns the result; ``tell(news)`` reports progress."""

Listener = Callable[[int, str, Any], None]
"""Called with the number of the request, "news", "done" or "error", and what belongs to it; in a thread of its own."""

_INTERRUPT = signal.SIGUSR1
_PATIENCE = 2.0  # [s] for the process to leave by itself


class NewestFirst:
    """The parent's end.

    Args:
        listener: hears about the newest request, and about no other.
        name: of the process.
    """

    def __init__(self, listener: Listener, name: str = "studio-worker") -> None:
        self._listener, self._name = listener, name
        self._lock = threading.Lock()
        self._newest = 0
        self._closing = self._ready = False
        self._start()

    @property
    def pid(self) -> int | None:
        """Of the process."""
        return self._process.pid

    def submit(self, job: Job, *arguments: Any) -> int:
        """Run a job as soon as what runs now has been interrupted; returns the number of the request."""
        with self._lock:
            self._newest += 1
            if self._closing:
                return self._newest
            with contextlib.suppress(OSError):  # a dead process is replaced by the thread that hears of it
                self._connection.send((self._newest, job, arguments))
            self._interrupt()
            return self._newest

    def close(self) -> None:
        """End the process; a second call does nothing."""
        with self._lock:
            if self._closing:
                return
            self._closing = True
            with contextlib.suppress(OSError):
                self._connection.send(None)
            self._interrupt()
        process = self._process
        process.join(_PATIENCE)
        for end in (process.terminate, process.kill):
            if process.is_alive():
                end()
                process.join(_PATIENCE)
        self._connection.close()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # inherited: the matrices are too small for a second thread
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs,), name=self._name, daemon=True)
        self._process.start()
        theirs.close()  # so that the end of the process closes the pipe
        threading.Thread(target=self._listen, args=(self._connection,), name=self._name, daemon=True).start()

    def _interrupt(self) -> None:
        # before it is ready nothing runs, and the signal would kill it
        if self._ready and self._process.pid is not None and self._process.is_alive():
            with contextlib.suppress(ProcessLookupError):
                os.kill(self._process.pid, _INTERRUPT)

    def _listen(self, connection: Connection) -> None:
        while True:
            try:
                number, kind, content = connection.recv()
            except (EOFError, OSError):
                break
            with self._lock:
                self._ready = True
                heard = number == self._newest and number > 0 and not self._closing
            if heard:
                self._listener(number, kind, content)
        with self._lock:
            if self._closing:
                return
            self._ready = False
            self._start()
            number = self._newest
        self._listener(number, "error", "the worker process ended; it was started again")


class _Interrupted(BaseException):
    """A newer request has come; no handler of errors may keep it."""


def serve(connection: Connection) -> None:
    """The process: wait for requests, run the newest, tell the parent. Ends with its parent, or when told to.

    Args:
        connection: to the parent.
    """
    working = False

    def on_interrupt(_: int, __: object) -> None:
        # the signal may come late, when the job it was meant for is over and the newer one runs
        if working and connection.poll():
            raise _Interrupted

    def tell(number: int, kind: str, content: Any) -> None:
        nonlocal working
        before, working = working, False  # half a message would be worse than a late interruption
        connection.send((number, kind, content))
        working = before
        on_interrupt(0, None)

    signal.signal(_INTERRUPT, on_interrupt)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is for the parent, which closes this process
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with contextlib.suppress(EOFError, OSError):
        tell(0, "ready", None)
        while True:
            request = connection.recv()
            while connection.poll():
                request = connection.recv()
            if request is None:
                return
            number, job, arguments = request
            try:
                working = True
                try:
                    result = job(lambda news, number=number: tell(number, "news", news), *arguments)
                finally:
                    working = False
                tell(number, "done", result)
            except _Interrupted:
                working = False
                _forget()
            except FrontalBipedError as error:
                tell(number, "error", str(error))
            except (EOFError, OSError):
                raise
            except Exception as error:
                # told on screen instead of ending the process; a studio must outlive a surprise
                tell(number, "error", f"{type(error).__name__}: {error}")


def _forget() -> None:
    """Whatever was interrupted half-way must not be used again."""
    from frontal_biped.studio import jobs

    jobs.robot.cache_clear()
