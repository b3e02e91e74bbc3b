"""The hybrid system of the full model: guards and reset ([O] eq. hybridsystem, with Sigma_f for its second half)."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped, Posture
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
    """A function of the state whose zero crossing is an event.

    Attributes:
        kind: of the event.
        function: q (4,), dq (4,) to a scalar.
        direction: -1 if only downward crossings count, +1 if only upward ones.
    """

    kind: EventKind
    function: Callable[[FloatArray, FloatArray], float]
    direction: int


@dataclass(frozen=True)
class Guards:
    """Guards of the two phases."""

    rising: tuple[Guard, ...]
    falling: tuple[Guard, ...]


def walking_guards(biped: FrontalBiped, leaving: float = 0.0, landing: float = 0.0) -> Guards:
    """Guards of a walking biped: reversal and impact, and the ways to fall.

    Args:
        biped: the robot, on its stance foot.
        leaving: height of the ground that the swing foot leaves, above the ground under the stance foot [m].
        landing: height of the ground on which it will land [m]; from the reversal on it is over that.
    """
    upright_height = float(biped.com(np.full(4, UPRIGHT))[1])
    outer, _ = biped.sole
    asked: list[tuple[FloatArray, Posture]] = []  # the last q, and the posture there

    def posture(q: FloatArray) -> Posture:
        """Three guards ask for it at the same q."""
        if not asked or asked[0][0] is not q:
            asked[:] = [(q, biped.posture(q))]
        return asked[0][1]

    def speed(_: FloatArray, dq: FloatArray) -> float:
        return dq.item(0)

    def clearance(q: FloatArray, _: FloatArray) -> float:
        at = posture(q)
        return min(at.inner_v, at.outer_v) - landing

    def grazing_clearance(q: FloatArray, _: FloatArray) -> float:
        at = posture(q)
        low, high = sorted((at.inner_v - leaving, at.outer_v - leaving))
        return low + GRAZE + LEAVING * min(max(2.0 - high / (2.0 * LEAVING), 0.0), 1.0)

    def inside_outer_edge(q: FloatArray, _: FloatArray) -> float:
        return posture(q).com_h - outer

    def height(q: FloatArray, _: FloatArray) -> float:
        return posture(q).com_v - LOWEST * upright_height

    fallen = (
        Guard(EventKind.TIPPED_OUTWARDS, inside_outer_edge, -1),
        Guard(EventKind.COLLAPSED, height, -1),
    )
    return Guards(
        rising=(
            Guard(EventKind.REVERSAL, speed, -1),
            Guard(EventKind.EARLY_LANDING, grazing_clearance, -1),
            *fallen,
        ),
        falling=(
            Guard(EventKind.IMPACT, clearance, -1),
            Guard(EventKind.TURNED_OUTWARDS, speed, +1),
            *fallen,
        ),
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
