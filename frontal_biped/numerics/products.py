"""Matrix products in pieces too small for BLAS to share out among threads: the digits must not depend on their number.

A sum over threads adds up in another order than a sum in one.
"""

import numpy as np

from frontal_biped.arrays import FloatArray

SINGLE_THREAD = 100_000
"""Multiplications below which BLAS keeps to one thread; OpenBLAS shares a product out from 262144 on."""


def product(A: FloatArray, B: FloatArray) -> FloatArray:
    """A @ B (m, n), some columns of B (k, n) at a time."""
    size = max(1, SINGLE_THREAD // max(A.size, 1))
    pieces = [A @ B[:, begin : begin + size] for begin in range(0, B.shape[1], size)]
    return np.concatenate(pieces, axis=1) if pieces else np.zeros((len(A), 0))


def squared(R: FloatArray) -> FloatArray:
    """R'R (n, n), some rows of R (m, n) at a time."""
    size = max(1, SINGLE_THREAD // max(R.shape[1] ** 2, 1))
    transposed = R.T.copy()  # a matrix of its own: of R and R' NumPy asks another BLAS routine, with other limits
    total = np.zeros((R.shape[1], R.shape[1]))
    for begin in range(0, len(R), size):
        total += transposed[:, begin : begin + size] @ R[begin : begin + size]
    return total
