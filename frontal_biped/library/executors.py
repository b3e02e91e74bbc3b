"""Executors on which a library is designed: worker processes that end with their parent, and Dask."""

import contextlib
import multiprocessing
import multiprocessing.connection
import os
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor

from frontal_biped.exceptions import LibraryError
from frontal_biped.files.extras import missing_extra


def worker_processes(count: int) -> ProcessPoolExecutor:
    """Executor of local processes, each on one thread; they end with the process that started them, however it ends."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # inherited: the matrices are too small for a second thread
    return ProcessPoolExecutor(count, mp_context=multiprocessing.get_context("spawn"), initializer=_end_with_parent)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            multiprocessing.connection.wait([parent.sentinel])
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


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
