"""The simplest controller there is: a function of time, joint positions and joint velocities that returns torques.

    def law(t, q, v):
        return {name: 200.0 * (reference[name] - q[name]) - 5.0 * v[name] for name in q}

``t`` is the time of the walk [s], ``q`` and ``v`` are dictionaries of position [rad] and velocity [rad/s] by URDF joint
name, as the encoders read them: of the four roll joints in the plane, of every joint that moves in space. It returns
the torque [N m] of every joint of ``q``, by name or as an array in the order of ``q``. It has no parameter called
``period``: that is how a function that makes a controller is told from it.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from numbers import Real
from typing import Any, TypeGuard

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ControllerError
from frontal_biped.numerics.by_name import suggestion

JointLaw = Callable[[float, dict[str, float], dict[str, float]], Any]
"""Called as law(t, q, v); see the module."""


def is_joint_law(thing: object) -> TypeGuard[JointLaw]:
    """Is an object called as (t, q, v), with no parameter ``period`` that a factory of controllers has?"""
    if isinstance(thing, type) or not callable(thing):
        return False
    try:
        signature = inspect.signature(thing)
        signature.bind(0.0, {}, {})
    except (TypeError, ValueError):
        return False
    kinds = {parameter.kind for parameter in signature.parameters.values()}
    return "period" not in signature.parameters and inspect.Parameter.VAR_KEYWORD not in kinds


class AskedLaw:
    """A law with its joints: asked with arrays, and its answers checked.

    Args:
        law: of the user.
        names: (n) of the joints.
        period: time between readings [s], for rates that the sensors do not tell.
    """

    def __init__(self, law: JointLaw, names: Sequence[str], period: float) -> None:
        self._law, self._names, self._period = law, tuple(names), period
        self.reset()

    def reset(self) -> None:
        """Forget the readings so far."""
        self._last: FloatArray | None = None

    def torques(self, t: float, positions: FloatArray, velocities: FloatArray | None) -> FloatArray:
        """(n,) torques [N m].

        Args:
            t: time of the walk [s].
            positions: (n,) [rad].
            velocities: (n,) [rad/s]; None: the difference from the reading before stands in.

        Raises:
            ControllerError: the law fails, or returns what is no torque of each joint; one line.
        """
        if velocities is None:
            velocities = np.zeros_like(positions) if self._last is None else (positions - self._last) / self._period
        self._last = positions
        q, v = (dict(zip(self._names, values.tolist(), strict=True)) for values in (positions, velocities))
        where = f"the controller {getattr(self._law, '__name__', type(self._law).__name__)!r} at t = {t:.4f} s"
        try:
            answer = self._law(t, q, v)
        except Exception as error:  # whatever the user's function does
            raise ControllerError(f"{where} fails, {type(error).__name__}: {error}; mend it") from error
        return checked_torques(answer, self._names, where)


def checked_torques(answer: object, names: Sequence[str], where: str) -> FloatArray:
    """(n,) torques [N m] of what a law has returned.

    Args:
        answer: of the law.
        names: (n) of the joints.
        where: which law when, for messages.

    Raises:
        ControllerError: it is neither a finite number for each joint by name, nor an array of them; one line that says
            what to return.
    """
    wanted = f"return a dict of torques (N m) of all {len(names)} joints, {{{names[0]!r}: 0.0, ...}}"
    if isinstance(answer, Mapping):
        strange = [name for name in answer if name not in names]
        if strange:
            raise ControllerError(
                f"{where} returned a torque of {strange[0]!r}, which is no joint here; {suggestion(strange[0], names)}"
            )
        missing = [name for name in names if name not in answer]
        if missing:
            raise ControllerError(f"{where} returned no torque of {missing[0]!r}; {wanted}")
        return np.array([_torque(answer[name], name, where) for name in names])
    if isinstance(answer, np.ndarray | list | tuple):
        shape = np.shape(answer) if isinstance(answer, np.ndarray) else (len(answer),)
        if shape != (len(names),):
            raise ControllerError(f"{where} returned an array of shape {shape}, not {(len(names),)}; {wanted}")
        return np.array([_torque(value, name, where) for value, name in zip(answer, names, strict=True)])
    raise ControllerError(f"{where} returned {type(answer).__name__}; {wanted}")


def _torque(value: object, name: str, where: str) -> float:
    value = value.item() if isinstance(value, np.ndarray | np.generic) and value.size == 1 else value
    if not isinstance(value, Real) or not math.isfinite(value):
        shown = " ".join(repr(value).split())[:40]
        raise ControllerError(
            f"{where} returned {shown} as the torque of {name!r}; return a finite number of newton metres"
        )
    return float(value)
