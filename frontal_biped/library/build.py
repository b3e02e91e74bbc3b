"""Design every gait of a grid, on any executor, so that the work can be killed and taken up again.

A batch is a run of neighbours: every gait starts from the last one found in it, as it stands in its file. What a batch
yields therefore depends on the batch alone, not on the executor, the number of workers or the interruptions.
"""

import itertools
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from queue import Empty, SimpleQueue

from frontal_biped.design.optimise import optimise_gait
from frontal_biped.exceptions import FrontalBipedError, LibraryError
from frontal_biped.library.executors import lost_workers
from frontal_biped.library.lock import locked
from frontal_biped.library.store import LibraryStore
from frontal_biped.library.sweep import GridPoint, Sweep
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import load_robot

POLL = 0.5  # [s] between two looks at what has been finished

Progress = Callable[[int, int, float], None]


@dataclass(frozen=True)
class LibraryReport:
    """What a run of the builder did.

    Attributes:
        index: the table of the library.
        points: size of the grid.
        gaits: points that have a gait.
        failures: points that have none.
        found: points that an earlier run had finished.
        seconds: wall time of this run.
    """

    index: Path
    points: int
    gaits: int
    failures: int
    found: int
    seconds: float

    @property
    def gaits_per_second(self) -> float:
        """Points finished by this run per second of wall time."""
        return (self.points - self.found) / self.seconds if self.seconds > 0.0 else 0.0


def build_library(
    sweep: Sweep, folder: Path, executor: Executor | None = None, on_progress: Progress | None = None
) -> LibraryReport:
    """Design what is still missing, and write the index.

    Args:
        sweep: the grid.
        folder: of the library, on a file system that the workers share.
        executor: any `concurrent.futures.Executor`: `worker_processes`, Dask's ``Client().get_executor()``,
            ``mpi4py.futures.MPIPoolExecutor``; default: one gait after another in this process.
        on_progress: called with points finished, points in all, and seconds since the start.

    Returns:
        What was done.

    Raises:
        LibraryError: the folder holds a library of another grid or other robots, or a file that is not of its point;
            another process is building it; or a worker is lost. What is finished is kept.
        RobotError: a robot of the grid cannot be loaded.
    """
    _robot.cache_clear()  # a file may have been edited since
    fingerprints = {robot: _robot(robot).fingerprint for robot in sweep.robots}
    with locked(folder):
        return _build(sweep, LibraryStore(folder), fingerprints, executor, on_progress)


def _build(
    sweep: Sweep,
    store: LibraryStore,
    fingerprints: Mapping[str, str],
    executor: Executor | None,
    on_progress: Progress | None,
) -> LibraryReport:
    began = time.perf_counter()
    store.open_for(sweep, fingerprints)
    points, batches = sweep.points(), sweep.batches()
    found = sum(store.finished(point.number) for point in points)

    def show(designed: int) -> None:
        if on_progress is not None:
            on_progress(found + designed, len(points), time.perf_counter() - began)

    show(0)
    missing = [tuple(point for point in batch if not store.finished(point.number)) for batch in batches]
    open_batches = [(batch, lacking) for batch, lacking in zip(batches, missing, strict=True) if lacking]
    if executor is None:
        designed = itertools.count(1)
        for batch, _ in open_batches:
            design_batch(store.folder, batch, lambda: show(next(designed)))
    else:
        _spread(executor, store, open_batches, show)
    index = store.write_index(sweep)
    gaits = sum(store.gait_path(point.number).is_file() for point in points)
    seconds = time.perf_counter() - began
    return LibraryReport(index, len(points), gaits, len(points) - gaits, found, seconds)


def _spread(
    executor: Executor,
    store: LibraryStore,
    batches: list[tuple[tuple[GridPoint, ...], tuple[GridPoint, ...]]],
    show: Callable[[int], None],
) -> None:
    """Hand out batches, each with the points that it lacks, and show how many of these are designed.

    What a batch costs here does not grow with their number: finished ones report themselves, and files are looked for
    only of those at work, where the executor says which these are.
    """
    done: SimpleQueue[Future[int]] = SimpleQueue()
    waiting: dict[Future[int], tuple[GridPoint, ...]] = {}
    designed, shown = 0, time.monotonic()
    try:
        for batch, lacking in batches:
            future = executor.submit(design_batch, store.folder, batch)
            waiting[future] = lacking
            future.add_done_callback(done.put)
        while waiting:
            try:
                future = done.get(timeout=POLL)
            except Empty:
                pass
            else:
                future.result()
                designed += len(waiting.pop(future))
            if not waiting or time.monotonic() - shown >= POLL:
                shown = time.monotonic()
                at_work = (point for future, lacking in waiting.items() if future.running() for point in lacking)
                show(designed + sum(store.finished(point.number) for point in at_work))
    except lost_workers():
        raise LibraryError(
            f"{store.folder}: a worker ended before its work, killed or out of memory; run it again: what is finished"
            " is kept"
        ) from None
    finally:
        for future in waiting:
            future.cancel()


def design_batch(folder: Path, batch: tuple[GridPoint, ...], on_point: Callable[[], None] | None = None) -> int:
    """Design the points of one batch that are not finished yet; what a worker runs.

    Args:
        folder: of the library.
        batch: neighbours in the grid.
        on_point: called after every point.

    Returns:
        Number of points designed.

    Raises:
        LibraryError: a file of the batch is not of its point, or the robot is not the library's any more.
    """
    store = LibraryStore(folder)
    fingerprints = store.fingerprints()
    designed = 0
    for i, point in enumerate(batch):
        if store.finished(point.number):
            continue
        found = (store.gait(before, fingerprints) for before in reversed(batch[:i]))
        start = next((gait for gait in found if gait is not None), None)
        biped = _robot_of(point.robot, fingerprints[point.robot])
        try:
            result = optimise_gait(biped, point.specification, start=start)
            gait, message = result.gait, result.message
        except FrontalBipedError as error:  # a point without a pose to start from must not end the batch
            gait, message = None, str(error)
        store.save(point, gait, message, biped.fingerprint)
        designed += 1
        if on_point is not None:
            on_point()
    return designed


def _robot_of(name: str, fingerprint: str) -> FrontalBiped:
    """The robot that the library is of; a worker may have known another one of that name."""
    if _robot(name).fingerprint != fingerprint:
        _robot.cache_clear()
    biped = _robot(name)
    if biped.fingerprint != fingerprint:
        raise LibraryError(f"{biped.path}: has changed while the library was built; put it back and run it again")
    return biped


@lru_cache(maxsize=8)
def _robot(name: str) -> FrontalBiped:
    return load_robot(name)
