"""One thread for linear algebra: matrices of four joints are too small for a second, which costs time to start."""

import os

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables by which OpenMP, OpenBLAS and MKL are told how many threads to use; read as each is imported."""


def one_thread() -> None:
    """Ask for it: of what this process is still to import, and of those that it starts. What the user set stays."""
    for name in THREADS:
        os.environ.setdefault(name, "1")
