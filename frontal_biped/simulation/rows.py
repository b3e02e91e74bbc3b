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
        self._room = 0  # rows that the last block has room for

    def add(self, values: Mapping[str, ArrayLike]) -> None:
        """Add a row: a number, or an array of them, for every column."""
        if not self._room:
            for name, blocks in self._columns.items():
                blocks.append(np.empty((BLOCK, *np.shape(values[name]))))
            self._room = BLOCK
        at = BLOCK - self._room
        for name, blocks in self._columns.items():
            blocks[-1][at] = values[name]
        self._room -= 1

    def add_many(self, values: Mapping[str, FloatArray]) -> None:
        """Add rows: an array (m, ...) for every column, which is kept."""
        self._close()
        for name, blocks in self._columns.items():
            blocks.append(values[name])

    def copy(self) -> "Rows":
        """The rows so far, to which others may be added."""
        self._close()
        twin = Rows(self._columns)
        twin._columns = {name: [*blocks] for name, blocks in self._columns.items()}
        return twin

    def _close(self) -> None:
        """No more rows into the last block."""
        if self._room:
            for blocks in self._columns.values():
                blocks[-1] = blocks[-1][: BLOCK - self._room]
            self._room = 0

    def take(self) -> dict[str, FloatArray]:
        """The columns, time first, (T, ...); they are handed over one by one, and none is kept."""
        self._close()
        found = {}
        for name, blocks in self._columns.items():
            found[name] = np.concatenate(blocks) if blocks else np.empty(0)
            blocks.clear()
        return found
