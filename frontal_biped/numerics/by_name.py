"""Columns of an array by name, and what is said of a name that is none of them."""

import difflib
from collections.abc import Iterator, Mapping, Sequence

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnknownNameError


class Columns(Mapping[str, FloatArray]):
    """The columns of an array (T, n) as a mapping from n names to (T,) views.

    Args:
        names: (n) of the columns, in their order.
        values: (T, n).
        what: a name stands for, in the singular, for messages.

    Raises:
        UnknownNameError: asked for a name that is none of them; a `KeyError` too, so that ``get`` and ``in`` work.
    """

    def __init__(self, names: Sequence[str], values: FloatArray, what: str = "joint") -> None:
        self._column = {name: i for i, name in enumerate(names)}
        self._values, self._what = values, what

    def __getitem__(self, name: str) -> FloatArray:
        if name not in self._column:
            raise UnknownNameError(f"no {self._what} {name!r}; {suggestion(name, tuple(self._column))}")
        column: FloatArray = self._values[:, self._column[name]]
        return column

    def __iter__(self) -> Iterator[str]:
        return iter(self._column)

    def __len__(self) -> int:
        return len(self._column)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self)})"


def suggestion(name: object, known: Sequence[str]) -> str:
    """What to write in place of a name that is not known: the nearest known one, or all of them."""
    near = difflib.get_close_matches(str(name), known, n=1)
    return f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"
