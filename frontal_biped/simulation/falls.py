"""What to ask more of where a certified gait does not walk: for every way to fail the keys that govern it.

A key is tightened in stages; a stage that is no tighter than what is asked already is passed over. A message names the
first stage, `design` tries them one after another.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.loop import TIMED_OUT, TOO_STIFF

OFF_SPEED = "the robot walks, but not as fast as the gait"
"""Outcome of a walk without a fall whose speed half-way down or step time is too far from the closed form."""

LEVEL = (0.05, 0.02)
"""Rotations of the swing foot from flat that are tried [rad]; our simulator calls a landing at more than 0.02 rad one
on an edge, and a light foot is off its path by some hundredths."""

HIGHER = (1.5, 2.0)
"""Factors of the swing foot's clearance."""

INSIDE = (2.0, 4.0)
"""Factors of the distance that the FRI keeps from the ends of the sole: room for whatever keeps the energy."""

LONGER = (1.25, 1.5)
"""Factors of the shortest step: a longer one has a larger range of beta, and more time to take an error off."""

FIRMER = (0.7, 0.5)
"""Factors of the coefficient of friction that a gait may use."""


@dataclass(frozen=True)
class Remedy:
    """One change of a specification that makes it tighter.

    Attributes:
        key: of the specification.
        old: its value; None: it was free.
        new: what takes its place.
    """

    key: str
    old: Any
    new: Any

    def of(self, spec: GaitSpecification) -> GaitSpecification:
        """A specification with the change."""
        return replace(spec, **{self.key: self.new})

    def __str__(self) -> str:
        before = "free before" if self.old is None else f"before {_short(self.old)}"
        return f"{self.key} = {_short(self.new)} ({before})"


AnyRemedy = TypeVar("AnyRemedy", bound=Remedy)


def remedies(spec: GaitSpecification, outcome: str, kind: type[AnyRemedy]) -> Iterator[AnyRemedy]:
    """Changes of a specification against a failure, those that cost least first.

    Args:
        spec: what is asked.
        outcome: of a walk.
        kind: of the changes: `Remedy`, or one that tells more.
    """
    for stages in GOVERNING.get(outcome, EVERYTHING):
        for key, new in stages(spec):
            yield kind(key, getattr(spec, key), new)


def fall_remedy(outcome: str, specification: GaitSpecification) -> str | None:
    """What to change against a fall, in words; None where no key of the specification governs it.

    Args:
        outcome: of the run.
        specification: what its gait was designed for.
    """
    if outcome not in GOVERNING:
        return None
    first = next(remedies(specification, outcome, Remedy), None)
    if first is None:
        return None
    before = ", which is free now" if first.old is None else f" in place of {_short(first.old)}"
    return f"ask for {first.key} = {_short(first.new)}{before}, and design again"


Stages = Callable[[GaitSpecification], Iterator[tuple[str, Any]]]
"""Keys and what they become, one change after another."""


def _level(spec: GaitSpecification) -> Iterator[tuple[str, Any]]:
    now = spec.max_foot_rotation
    return (("max_foot_rotation", most) for most in LEVEL if now is None or most < now)


def _clearance(spec: GaitSpecification) -> Iterator[tuple[str, Any]]:
    return _scaled(spec, "swing_clearance", HIGHER)


def _inside(spec: GaitSpecification) -> Iterator[tuple[str, Any]]:
    return _scaled(spec, "fri_margin", INSIDE)


def _longer(spec: GaitSpecification) -> Iterator[tuple[str, Any]]:
    low, high = spec.step_duration
    return (("step_duration", (round(factor * low, 4), high)) for factor in LONGER if factor * low <= high)


def _firm(spec: GaitSpecification) -> Iterator[tuple[str, Any]]:
    return _scaled(spec, "friction", FIRMER)


def _scaled(spec: GaitSpecification, key: str, factors: tuple[float, ...]) -> Iterator[tuple[str, Any]]:
    """Of a bound at zero, which no factor makes tighter, the default."""
    now = getattr(spec, key)
    news = (factor * now for factor in factors) if now > 0.0 else (getattr(GaitSpecification, key),)
    return ((key, round(new, 6)) for new in news)


EVERYTHING: tuple[Stages, ...] = (_level, _clearance, _inside, _longer)
"""Against anything else."""

GOVERNING: Mapping[str, tuple[Stages, ...]] = {
    EventKind.EDGE_LANDING.value: (_level, _clearance, _longer, _inside),
    EventKind.EARLY_LANDING.value: (_clearance, _level, _longer, _inside),
    EventKind.TIPPED_OUTWARDS.value: (_inside, _level, _longer, _clearance),
    EventKind.TURNED_OUTWARDS.value: (_inside, _level, _longer, _clearance),
    EventKind.SLIPPED.value: (_firm, *EVERYTHING),
    EventKind.ROLLED.value: (_inside, _level, _longer, _clearance),
    EventKind.COLLAPSED.value: (_inside, _longer, _level, _clearance),
    TIMED_OUT: (_inside, _longer, _level, _clearance),
    TOO_STIFF: EVERYTHING,
    OFF_SPEED: (_inside, _longer, _level, _clearance),
}
"""What governs a failure."""


def _short(value: Any) -> str:
    return f"[{value[0]:.4g}, {value[1]:.4g}]" if isinstance(value, tuple) else f"{value:.4g}"
