r"""Where guards need no look: no height can have come to zero since they were looked at last.

Beside the rate of the stance ankle, guards look at points of the chain alone: ends of the swing sole and centre of
mass. Joint i moves a point beyond it on a circle about itself, whose radius is at most r_i, the length of the chain
from there to its farthest point; of the centre of mass only a part is moved. From one pose to another a point comes
therefore at most

.. math:: \sum_i r_i\, |q_i - q_i^0|

far, and a guard at most `SHARE` times as far: one that was farther from zero than that is still positive. The bound is
exact, so that where it tells of no event a look would not have found one either. It costs a sixth of a look.
"""

import math

from frontal_biped.model.chain import FrontalChain
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import Guards

SHARE = 1.5
"""What a guard changes at most where no point moves farther than one: that of a rising swing foot looks at the height
of one end of its sole and at half of the other's."""

ROUNDING = 1e-9
"""Far more than the heights of points are rounded by [m]."""


def reaches(chain: FrontalChain) -> tuple[float, float, float, float]:
    """From each of the four joints to the farthest point beyond it, the chain stretched out [m]."""
    beyond = max(math.hypot(end, chain.ankle_height) for end in (chain.sole_inner, chain.sole_outer))
    found: list[float] = []
    places = [*chain.joints.tolist(), None]
    for here, following, body in zip(places[3::-1], places[:0:-1], chain.bodies[:0:-1], strict=True):
        if following is not None:
            beyond += math.dist(here, following)
        beyond = max(beyond, math.dist(here, body.com.tolist()))
        found.append(beyond)
    swing_ankle, swing_hip, stance_hip, stance_ankle = found
    return stance_ankle, stance_hip, swing_hip, swing_ankle


class GuardWatch:
    """Watches the guards of a phase.

    Args:
        guards: of the phase.
        reach: `reaches` of the robot's chain.
        state: where it begins.
    """

    def __init__(self, guards: Guards, reach: tuple[float, float, float, float], state: State) -> None:
        self._guards, self._reach, self._sense = guards, reach, guards.sense
        self._looked_at(state, guards.values(*state))

    def look(self, state: State) -> tuple[float, ...] | None:
        """The guards' values at a state where one of them may be zero or below; None where none is."""
        q_1, q_2, q_3, q_4 = state.q.tolist()
        p_1, p_2, p_3, p_4 = self._pose
        r_1, r_2, r_3, r_4 = self._reach
        came = r_1 * abs(q_1 - p_1) + r_2 * abs(q_2 - p_2) + r_3 * abs(q_3 - p_3) + r_4 * abs(q_4 - p_4)
        if came < self._room and self._sense * state.dq.item(0) > 0.0:
            return None
        values = self._guards.values(*state)
        self._looked_at(state, values)
        return values if min(values) <= 0.0 else None

    def _looked_at(self, state: State, values: tuple[float, ...]) -> None:
        self._pose = state.q.tolist()
        turn = self._guards.turn
        self._room = min(values[:turn] + values[turn + 1 :]) / SHARE - ROUNDING
