"""Products in pieces against the whole ones, and the same digits whatever the number of threads."""

import os
import subprocess
import sys

import numpy as np
import pytest

from frontal_biped.numerics.products import SINGLE_THREAD, product, squared

SAME = 1e-13
"""Relative difference of sums that add up in another order."""

MANY = """
import hashlib
import numpy as np
from frontal_biped.numerics.products import product, squared
rng = np.random.default_rng(3)
A, B, R = rng.normal(size=(40, 33)), rng.normal(size=(33, 3000)), rng.normal(size=(2000, 47))
print(hashlib.sha256(product(A, B).tobytes() + squared(R).tobytes()).hexdigest())
"""


@pytest.mark.parametrize("shape", [(0, 3), (1, 1), (5, 3), (128, 31), (1000, 47)])
def test_squared(shape):
    R = np.random.default_rng(1).normal(size=shape)
    found = squared(R)
    np.testing.assert_allclose(found, R.T @ R, rtol=SAME, atol=SAME * max(1, shape[0]))
    assert np.array_equal(found, found.T)


@pytest.mark.parametrize("columns", [0, 1, 7, 3 * SINGLE_THREAD // 1000])
def test_product(columns):
    rng = np.random.default_rng(2)
    A, B = rng.normal(size=(40, 25)), rng.normal(size=(25, columns))
    np.testing.assert_allclose(product(A, B), A @ B, rtol=SAME, atol=SAME)


def test_digits_do_not_depend_on_threads():
    def digits(threads: str) -> str:
        there = {**os.environ, "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads}
        command = [sys.executable, "-c", MANY]
        return subprocess.run(command, env=there, capture_output=True, text=True, check=True).stdout

    assert digits("1") == digits("4")
