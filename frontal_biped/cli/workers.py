"""The processes that `--jobs` asks for."""

from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext

from frontal_biped.library.executors import worker_processes


def workers(jobs: int) -> AbstractContextManager[Executor | None]:
    """Worker processes; none for one job, which this process does itself."""
    return worker_processes(jobs) if jobs > 1 else nullcontext()
