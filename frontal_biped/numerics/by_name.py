"""Columns of an array by name, and what is said of a name that is none of them."""

import difflib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnknownNameError


class Columns(Mapping[str, FloatArray]):
    """The columns of an array (T, n) as a mapping from n names to (T,) views.

    Args:
        names: (n) of the columns, in their order.
        values: (T, n).
        what: a name stands for, in the singular, for messages.
        others: asked once, when a name is none of them: columns under other names, which are not counted among these.

    Raises:
        UnknownNameError: asked for a name that is none of them; a `KeyError` too, so that ``get`` and ``in`` work.
    """

    def __init__(
        self,
        names: Sequence[str],
        values: FloatArray,
        what: str = "joint",
        others: "Callable[[], Columns | None] | None" = None,
    ) -> None:
        self._column = {name: i for i, name in enumerate(names)}
        self._values, self._what, self._others = values, what, others

    def __getitem__(self, name: str) -> FloatArray:
        if name not in self._column:
            also = self._also
            if also is not None and name in also:
                return also[name]
            known = (*self._column, *(also or ()))
            raise UnknownNameError(f"no {self._what} {name!r}; {suggestion(name, known)}")
        column: FloatArray = self._values[:, self._column[name]]
        return column

    @cached_property
    def _also(self) -> "Columns | None":
        return None if self._others is None else self._others()

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
