"""Executors on which a library is designed: worker processes that end with their parent, and Dask."""

import contextlib
import multiprocessing
import multiprocessing.connection
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor
from pathlib import Path
from types import FrameType, TracebackType
from typing import ParamSpec, TypeVar

from frontal_biped.exceptions import Interruption, LibraryError
from frontal_biped.files.extras import missing_extra
from frontal_biped.files.signals import SIGNALS
from frontal_biped.numerics.threads import one_thread

P = ParamSpec("P")
T = TypeVar("T")

PATIENCE = 5.0
"""How long a worker that is told to stop may take for it before it is killed [s]."""


def worker_processes(count: int, *, copies: bool = False) -> ProcessPoolExecutor:
    """Executor of local processes, each on one thread; they end with the process that started them, however it ends.

    Used in a ``with`` statement, an error or Ctrl+C in the block stops them at once; what they were writing is removed.

    Args:
        count: of the processes.
        copies: may they begin as copies of this process, with all that it has imported? That saves each of them a
            second and more. Where a copy is not safe they start afresh all the same.
    """
    one_thread()  # inherited
    method = "fork" if copies and can_be_copied() else "spawn"
    return _WorkerProcesses(count, mp_context=multiprocessing.get_context(method), initializer=_begin)


def can_be_copied() -> bool:
    """Is this a process of Linux with one thread? What a second one holds locked, a copy would wait for in vain."""
    try:
        return sum(1 for _ in Path("/proc/self/task").iterdir()) == 1
    except OSError:
        return False


class _WorkerProcesses(ProcessPoolExecutor):
    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        # A process that is started here inherits the mask: what a terminal sends to all of them is for the parent, also
        # while a worker is still importing.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        try:
            return super().submit(_work, fn, args, kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> bool | None:
        if kind is None:
            return super().__exit__(kind, error, trace)
        processes = list((self._processes or {}).values())
        self.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.terminate()
        deadline = time.monotonic() + PATIENCE
        for process in processes:
            process.join(max(0.0, deadline - time.monotonic()))
            if process.is_alive():
                process.kill()
        return None


_working = False
"""Is this process a worker with work in hand?"""


def _begin() -> None:
    """The first that a worker does."""
    sys.stdout = sys.stderr  # standard output is the parent's report
    _end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _stop)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def _stop(number: int, _: FrameType | None) -> None:
    if _working:
        raise Interruption(number)  # removes what is half-written
    os._exit(128 + number)


def _work(fn: Callable[..., T], args: tuple[object, ...], kwargs: dict[str, object]) -> T:
    global _working
    _working = True
    try:
        return fn(*args, **kwargs)
    except Interruption as stop:
        os._exit(stop.exit_status)
    finally:
        _working = False


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            multiprocessing.connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def lost_workers() -> tuple[type[BaseException], ...]:
    """Errors that mean that a worker, or the way to it, is gone, not that its work went wrong."""
    dask = sys.modules.get("distributed")
    return (BrokenExecutor, *(() if dask is None else (dask.KilledWorker, dask.comm.CommClosedError, CancelledError)))


@contextlib.contextmanager
def dask_executor(address: str) -> Iterator[Executor]:
    """Executor of a running Dask cluster.

    Args:
        address: of the scheduler, for example ``tcp://host:8786``.

    Raises:
        MissingExtraError: Dask is not installed.
        LibraryError: no scheduler answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise missing_extra("--dask needs Dask", "dask") from None
    try:
        client = Client(address, timeout="10s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TimeoutError) as error:
        raise LibraryError(f"{address}: no Dask scheduler answers ({error}); start one with `dask scheduler`") from None
    with client:
        executor: Executor = client.get_executor()  # type: ignore[no-untyped-call]
        yield executor
