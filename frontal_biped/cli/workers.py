"""The processes that `--jobs` asks for."""

from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Executor
from contextlib import contextmanager

from frontal_biped.exceptions import FrontalBipedError


@contextmanager
def workers(jobs: int) -> Iterator[Executor | None]:
    """Worker processes; none for one job, which this process does itself.

    Raises:
        FrontalBipedError: one of them ended before its work.
    """
    with _processes(jobs, 0 if jobs == 1 else jobs) as executor:
        yield executor


@contextmanager
def helpers(jobs: int) -> Iterator[Executor | None]:
    """Worker processes beside this one, which does its share of the jobs; none for one job.

    Raises:
        FrontalBipedError: one of them ended before its work.
    """
    with _processes(jobs, jobs - 1) as executor:
        yield executor


@contextmanager
def _processes(jobs: int, count: int) -> Iterator[Executor | None]:
    if count == 0:
        yield None
        return
    from frontal_biped.library.executors import worker_processes

    try:
        with worker_processes(count) as executor:
            yield executor
    except BrokenExecutor:
        raise FrontalBipedError(
            f"--jobs {jobs}: a worker process ended before its work, killed or out of memory; run it again, perhaps"
            " with fewer --jobs"
        ) from None
