"""The array operations behind a formula, in their order, to be done again for other numbers.

The formulas of a design do the same operations at every point. What Python spends on finding out which those are, on
making the objects in between and on finding memory for them is more than the operations take; recorded once, they are
done again without it. Every result has an array of its own, which later operations read, as it is or in views. So
once the variables have new values in their array, doing all operations again puts new values everywhere.

Only what is recorded is done again: a number taken out of an array, or a branch taken, stays what it was.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray


class Tape:
    """Operations as they were done, each with its arguments and the array that takes its result."""

    def __init__(self) -> None:
        self._steps: list[tuple[Callable[..., Any], tuple[Any, ...]]] = []

    def add(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Note an operation that writes into one of its arguments."""
        self._steps.append((function, arguments))

    def run(self) -> None:
        """Do everything again."""
        for function, arguments in self._steps:
            function(*arguments)


def done(tape: Tape | None, function: Callable[..., Any], *arguments: Any) -> FloatArray:
    """The result of a function that takes the array for it as its last argument; done again if there is a tape."""
    result: FloatArray = np.asarray(function(*arguments))
    if tape is not None:
        tape.add(function, *arguments, result)
    return result


def written(tape: Tape | None, function: Callable[..., Any], *arguments: Any) -> None:
    """A function that writes into one of its arguments; done again if there is a tape."""
    function(*arguments)
    if tape is not None:
        tape.add(function, *arguments)


def filled(tape: Tape | None, shape: tuple[int, ...], fill: Callable[[FloatArray], None]) -> FloatArray:
    """The array of a shape that a function fills; filled again if there is a tape."""
    result = np.empty(shape)
    written(tape, fill, result)
    return result


def computed(tape: Tape | None, function: Callable[[], FloatArray]) -> FloatArray:
    """What a function returns; asked again, for an array of the same shape, if there is a tape."""
    result = function()
    if tape is not None:
        tape.add(_refresh, result, function)
    return result


def _refresh(result: FloatArray, function: Callable[[], FloatArray]) -> None:
    result[...] = function()


def looked_at(tape: Tape | None, source: FloatArray, view: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Elements of an array in another shape or order: a view where NumPy has one, else a copy, made again."""
    result = view(source)
    if tape is not None and result.size and not np.may_share_memory(result, source):
        tape.add(_refresh, result, lambda: view(source))
    return result
