"""Rows of a recording as they arrive, kept as bare numbers: a long walk costs no more memory than its arrays."""

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import ArrayLike

from frontal_biped.arrays import FloatArray

BLOCK = 1024
"""Rows for which there is room at a time; full blocks stay where they are."""


class Rows:
    """Named columns of equal length that grow by a row at a time.

    Args:
        names: of the columns; the first row says how many numbers each of them holds.
    """

    def __init__(self, names: Iterable[str]) -> None:
        self._columns: dict[str, list[FloatArray]] = {name: [] for name in names}
        self._count = 0

    def add(self, values: Mapping[str, ArrayLike]) -> None:
        """Add a row: a number, or an array of them, for every column."""
        at = self._count % BLOCK
        for name, blocks in self._columns.items():
            value = values[name]
            if at == 0:
                blocks.append(np.empty((BLOCK, *np.shape(value))))
            blocks[-1][at] = value
        self._count += 1

    def take(self) -> dict[str, FloatArray]:
        """The columns, time first, (T, ...); they are handed over one by one, and none is kept."""
        missing = -self._count % BLOCK
        found = {}
        for name, blocks in self._columns.items():
            if missing:
                blocks[-1] = blocks[-1][: BLOCK - missing]
            found[name] = np.concatenate(blocks) if blocks else np.empty(0)
            blocks.clear()
        self._count = 0
        return found
