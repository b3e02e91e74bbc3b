"""Gait libraries: a grid of specifications designed on any executor, kept on disk, and interpolated."""

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
