"""What a controller that is an object may answer: checked where it drives a robot, for users write controllers too."""

from collections.abc import Iterable, Mapping
from math import isfinite
from operator import attrgetter
from typing import Any

import numpy as np

from frontal_biped.control.interface import PhaseEvent
from frontal_biped.exceptions import ControllerError
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase

_NUMBER, _MISSING = np.dtype(float), object()

_NUMBERS: Mapping[str, Mapping[str, int]] = {"tick": {"q": 4, "y": 3}, "command": {"y": 3}}
"""What a simulator reads of an answer beside the torques: how many numbers an attribute holds."""

_KINDS: Mapping[str, Mapping[str, Any]] = {
    "tick": {"phase": StepPhase, "stance": Stance, "event": (PhaseEvent, type(None))},
    "command": {},
}
"""And of which class others are."""


_USUAL = {
    asked: (
        attrgetter(*numbers, *_KINDS[asked], "p_fri_target"),
        [(size,) for size in numbers.values()],
        list(_KINDS[asked].values()),
    )
    for asked, numbers in _NUMBERS.items()
}
"""The attributes of an answer in one look, the shapes of the arrays among them, and the classes of what follows."""


def check_answer(answer: object, torques: str, count: int, asked: str, t: float, also: Iterable[str] = ()) -> None:
    """Raise ControllerError, in one line, for an answer without torques that motors could give, or without the rest.

    Args:
        answer: of the controller.
        torques: attribute of the answer that holds them.
        count: how many there must be.
        asked: the method that was asked, "tick" or "command".
        t: when [s].
        also: names that the answer must have besides.
    """
    values = getattr(answer, torques, None)
    if not also and _is_usual(answer, values, (count,), asked):
        return
    numbers = _numbers(values, count)
    if numbers is None or not _finite(numbers):
        told = f"with {torques} = {_shown(values)}" if hasattr(answer, torques) else f"without {torques}"
        raise ControllerError(
            f"the controller's {asked} at t = {t:.4f} s returned {type(answer).__name__} {told}; return an object whose"
            f" {torques} are {count} finite numbers (N m)"
        )
    for name, kind in _KINDS[asked].items():
        if not isinstance(getattr(answer, name, _MISSING), kind):
            raise _refusal(answer, asked, t, name, _words(kind))
    for name, size in _NUMBERS[asked].items():
        if _numbers(getattr(answer, name, _MISSING), size) is None:
            raise _refusal(answer, asked, t, name, f"{size} numbers")
    for name in ("p_fri_target", *also):
        if not hasattr(answer, name):
            raise ControllerError(
                f"the controller's {asked} at t = {t:.4f} s returned {type(answer).__name__} without {name};"
                " give it one"
            )


def _is_usual(answer: object, torques: object, shape: tuple[int], asked: str) -> bool:
    """Is all of it there, and every number in an array of its own? What our own controllers give, told sooner."""
    if not (type(torques) is np.ndarray and torques.dtype is _NUMBER and torques.shape == shape):
        return False
    look, shapes, kinds = _USUAL[asked]
    try:
        found = look(answer)
    except AttributeError:
        return False
    for values, size in zip(found, shapes, strict=False):
        if not (type(values) is np.ndarray and values.dtype is _NUMBER and values.shape == size):
            return False
    for value, kind in zip(found[len(shapes) :], kinds, strict=False):
        if not isinstance(value, kind):
            return False
    return isfinite(sum(torques.tolist()))


def _refusal(answer: object, asked: str, t: float, name: str, wanted: str) -> ControllerError:
    told = f"with {name} = {_shown(getattr(answer, name))}" if hasattr(answer, name) else f"without {name}"
    returned = f"the controller's {asked} at t = {t:.4f} s returned {type(answer).__name__} {told}"
    return ControllerError(f"{returned}; give it {wanted}")


def _numbers(values: object, count: int) -> np.ndarray[Any, Any] | None:
    """The array of so many real numbers that the values are; None: they are none."""
    if type(values) is np.ndarray and values.dtype is _NUMBER and values.shape == (count,):
        return values
    try:
        array = np.asarray(values)
    except Exception:  # a class of the user's may answer this with anything
        return None
    return array if array.shape == (count,) and array.dtype.kind in "iuf" else None


def _finite(numbers: np.ndarray[Any, Any]) -> bool:
    """Are all of them finite? Where their squares' sum is, they are, which is told much sooner."""
    return isfinite(numbers.dot(numbers)) or bool(np.isfinite(numbers).all())


def _shown(values: object) -> str:
    try:
        return " ".join(repr(values).split())[:60]
    except Exception:
        return type(values).__name__


def _words(wanted: Any) -> str:
    kinds = wanted if isinstance(wanted, tuple) else (wanted,)
    return " or ".join("None" if kind is type(None) else f"a member of {kind.__name__}" for kind in kinds)
