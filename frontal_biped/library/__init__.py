"""Gait libraries: a grid of specifications designed on any executor, kept on disk, and interpolated.

``frontal-biped library sweep.toml -o DIR --jobs 2`` designs a gait for every point of a grid (`sweep` has the file's
keys). Kill it at any moment and run it again: nothing is lost, nothing repeated, and ``DIR/index.csv`` comes out byte
for byte the same. A library knows the fingerprints of its robots, and every file its point: another robot, or a file
that is not of its point, is refused. One process at a time builds it.

From Python, ``build_library(sweep, folder, executor)`` takes any `concurrent.futures.Executor` whose workers share the
folder: ``worker_processes(2)``; Dask, ``--dask tcp://host:8786`` or ``Client(...).get_executor()``; MPI, run
``mpiexec -n 8 python -m mpi4py.futures script.py`` with an ``MPIPoolExecutor`` in the script.

Between the gaits, ``GaitLibrary(DIR).blend(robot, {...})`` returns a gait between grid points, invariant and periodic
to rounding; ``design_transition(robot, before, after)`` designs the single step that leads from one gait to another
without leaving the zero dynamics, and ``GaitSequence`` walks them one after the other.
"""

from frontal_biped.library.build import LibraryReport, build_library
from frontal_biped.library.executors import dask_executor, worker_processes
from frontal_biped.library.interpolation import GaitLibrary
from frontal_biped.library.store import LibraryStore
from frontal_biped.library.sweep import Sweep, read_sweep

__all__ = [
    "GaitLibrary",
    "LibraryReport",
    "LibraryStore",
    "Sweep",
    "build_library",
    "dask_executor",
    "read_sweep",
    "worker_processes",
]
