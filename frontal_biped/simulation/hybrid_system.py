"""The hybrid system of the full model: guards and reset ([O] eq. hybridsystem, with Sigma_f for its second half)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.impact import Landing, impact

FLAT_LANDING = 0.02
"""Largest rotation of the swing foot [rad] that settles flat at impact; a steeper one is a stumble."""

LOWEST = 0.6
"""Height of the centre of mass, relative to upright, below which the robot has fallen."""

GRAZE = 1e-6
"""How far [m] the swing sole may dip below the ground while rising before that counts as touching it; rounding at
lift-off is far below."""

LEAVING = 1e-3
"""How far [m] one end of a sole may dip that has not left the ground yet, neither end higher than twice as far.

Torques that are held act on past the impact, and the old stance ankle's turns a light foot that the ground would still
hold up; a foot that lands may be as far off (`FLAT_LANDING` over the width of a sole)."""


class EventKind(Enum):
    """What ends a phase."""

    REVERSAL = "reversal"
    IMPACT = "impact"
    TURNED_OUTWARDS = "pushed outwards again while falling"
    EARLY_LANDING = "the swing foot touched the ground before the reversal"
    TIPPED_OUTWARDS = "the robot tipped over its stance foot, away from the swing foot"
    COLLAPSED = "the centre of mass dropped below 60 % of its upright height"
    EDGE_LANDING = "the swing foot landed on its edge"
    SLIPPED = "the stance foot slipped: the ground reaction left the friction cone"
    ROLLED = "the stance foot rolled over its edge: the FRI left the sole"


class Guard(NamedTuple):
    """A function of the state that is positive until an event: its downward crossing of zero.

    Attributes:
        kind: of the event.
        function: q (4,), dq (4,) to a scalar.
    """

    kind: EventKind
    function: Callable[[FloatArray, FloatArray], float]


@dataclass(frozen=True)
class Guards:
    """Guards of a phase.

    Attributes:
        kinds: of their events.
        values: of all of them at q (4,), dq (4,).
        turn: which of them tells of a turn of the stance ankle: its value is the ankle's rate times ``sense``.
        sense: of that rate in this phase, +1 or -1. The other guards are functions of q alone.
    """

    kinds: tuple[EventKind, ...]
    values: Callable[[FloatArray, FloatArray], tuple[float, ...]]
    turn: int
    sense: float

    def __iter__(self) -> Iterator[Guard]:
        """One after another."""
        for place, kind in enumerate(self.kinds):
            yield Guard(kind, self._function(place))

    def _function(self, place: int) -> Callable[[FloatArray, FloatArray], float]:
        return lambda q, dq: self.values(q, dq)[place]


@dataclass(frozen=True)
class WalkingGuards:
    """Guards of the two phases."""

    rising: Guards
    falling: Guards


def walking_guards(biped: FrontalBiped, leaving: float = 0.0, landing: float = 0.0) -> WalkingGuards:
    """Guards of a walking biped: reversal and impact, and the ways to fall.

    Args:
        biped: the robot, on its stance foot.
        leaving: height of the ground that the swing foot leaves, above the ground under the stance foot [m].
        landing: height of the ground on which it will land [m]; from the reversal on it is over that.
    """
    lowest = LOWEST * float(biped.com(np.full(4, UPRIGHT))[1])
    outer, _ = biped.sole

    def rising(q: FloatArray, dq: FloatArray) -> tuple[float, ...]:
        com_h, com_v, inner, outer_end = biped.posture(q)
        low, high = (inner, outer_end) if inner < outer_end else (outer_end, inner)
        graze = GRAZE + LEAVING * min(max(2.0 - (high - leaving) / (2.0 * LEAVING), 0.0), 1.0)
        return dq.item(0), low - leaving + graze, com_h - outer, com_v - lowest

    def falling(q: FloatArray, dq: FloatArray) -> tuple[float, ...]:
        com_h, com_v, inner, outer_end = biped.posture(q)
        return min(inner, outer_end) - landing, -dq.item(0), com_h - outer, com_v - lowest

    fallen = (EventKind.TIPPED_OUTWARDS, EventKind.COLLAPSED)
    return WalkingGuards(
        Guards((EventKind.REVERSAL, EventKind.EARLY_LANDING, *fallen), rising, 0, +1.0),
        Guards((EventKind.IMPACT, EventKind.TURNED_OUTWARDS, *fallen), falling, 1, -1.0),
    )


def land(
    biped: FrontalBiped, q_minus: FloatArray, dq_minus: FloatArray, flat_landing: float = FLAT_LANDING
) -> Landing | None:
    """Reset at impact: rigid impact and relabelling; None for a landing too steep to settle flat.

    A foot that lands at a small angle settles flat at once: the rest of the robot keeps its orientation, so that
    angle is taken out of the new stance ankle.
    """
    rotation = float(biped.swing_foot_rotation(q_minus))
    if abs(rotation) > flat_landing:
        return None
    landing = impact(biped, q_minus, dq_minus)
    q_plus = landing.q_plus.copy()
    q_plus[0] -= rotation
    return landing._replace(q_plus=q_plus)
