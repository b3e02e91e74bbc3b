"""What to ask more of, where a certified gait does not walk: for every way to fail the keys that govern it.

A key is tightened in stages; a stage that is no tighter than what is asked already is passed over.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from frontal_biped.design.walk_trial import OFF_SPEED
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.simulation.hybrid_system import EventKind

LEVEL = (0.05, 0.02)
"""Rotations of the swing foot from flat that are tried [rad]; our simulator calls a landing at more than 0.02 rad one
on an edge, and a light foot is off its path by some hundredths."""

HIGHER = (1.5, 2.0)
"""Factors of the swing foot's clearance."""

INSIDE = (2.0, 4.0)
"""Factors of the distance that the FRI keeps from the ends of the sole: room for whatever keeps the energy."""

LONGER = (1.25, 1.5)
"""Factors of the shortest step: a longer one has a larger range of beta, and more time to take an error off."""


@dataclass(frozen=True)
class Tightening:
    """One change of a specification.

    Attributes:
        key: of the specification.
        old: its value; None: it was free.
        new: what takes its place.
        event: what it is against.
        engine: where that was seen.
    """

    key: str
    old: Any
    new: Any
    event: str = ""
    engine: str = ""

    def of(self, spec: GaitSpecification) -> GaitSpecification:
        """A specification with the change."""
        return replace(spec, **{self.key: self.new})

    def __str__(self) -> str:
        before = "free before" if self.old is None else f"before {_short(self.old)}"
        return f"{self.key} = {_short(self.new)} ({before}) against: {self.event}, in {self.engine}"


def tightenings(spec: GaitSpecification, event: str) -> Iterator[Tightening]:
    """Changes of a specification against an event, those that cost least first.

    Args:
        spec: what is asked.
        event: outcome of a walk.
    """
    for of in GOVERNING.get(event, EVERYTHING):
        yield from of(spec)


def _level(spec: GaitSpecification) -> Iterator[Tightening]:
    now = spec.max_foot_rotation
    for most in LEVEL:
        if now is None or most < now:
            yield Tightening("max_foot_rotation", now, most)


def _clearance(spec: GaitSpecification) -> Iterator[Tightening]:
    now = spec.swing_clearance
    return (Tightening("swing_clearance", now, round(factor * now, 6)) for factor in HIGHER)


def _inside(spec: GaitSpecification) -> Iterator[Tightening]:
    now = spec.fri_margin
    return (Tightening("fri_margin", now, round(factor * now, 6)) for factor in INSIDE)


def _longer(spec: GaitSpecification) -> Iterator[Tightening]:
    low, high = spec.step_duration
    for factor in LONGER:
        if factor * low <= high:
            yield Tightening("step_duration", spec.step_duration, (round(factor * low, 4), high))


Stages = Callable[[GaitSpecification], Iterator[Tightening]]

EVERYTHING: tuple[Stages, ...] = (_level, _clearance, _inside, _longer)
"""Against anything else."""

GOVERNING: Mapping[str, tuple[Stages, ...]] = {
    EventKind.EDGE_LANDING.value: (_level, _clearance, _longer, _inside),
    EventKind.EARLY_LANDING.value: (_clearance, _level, _longer, _inside),
    EventKind.TIPPED_OUTWARDS.value: (_inside, _level, _longer, _clearance),
    EventKind.TURNED_OUTWARDS.value: (_inside, _level, _longer, _clearance),
    OFF_SPEED: (_inside, _longer, _level, _clearance),
}
"""What governs an event."""


def _short(value: Any) -> str:
    return f"[{value[0]:.4g}, {value[1]:.4g}]" if isinstance(value, tuple) else f"{value:.4g}"
