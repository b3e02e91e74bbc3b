"""Lengths of both virtual legs along a step: the swing leg is drawn up, and put down where the ground is.

The plane knows no knees: its swing foot clears the ground by the sway of the pelvis alone. In space the swing leg is
shortened as well and stretched again, so that it meets the ground with a speed of its own. On ground that comes too
early it is shorter than planned then, on ground that does not come it goes on growing: the robot lands nearer to the
pose of the plane than on legs that keep their length. The leg that landed takes its length back while it carries the
robot, long before it is lifted.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.control.spatial_walker.swing_path import MinimumJerk
from frontal_biped.control.whole_body.targets import LegLength
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import ANGLE, LENGTH, SpaceState, X
from frontal_biped.model.stance_map import Stance

PEAK = 1.875
"""Largest speed of a minimum-jerk motion from rest to rest, over its mean speed [-]."""


@dataclass(frozen=True)
class LengthSettings:
    """How the legs' lengths change.

    Attributes:
        lift: by how much of its length the swing leg is drawn up [-].
        highest: share of a step at which it is shortest [-].
        touchdown: speed with which it is stretched at the landing [m/s].
        longest: by how much of its length it is stretched at most where no ground comes [-].
        recovery: share of a step after which the stance leg has its own length again [-].
        speed_share: share of its joints' largest speed that drawing the leg up may take: of a leg that is all but
            straight, every joint has to turn far for little [-].
    """

    lift: float = 0.031
    highest: float = 0.5
    touchdown: float = 0.05
    longest: float = 0.023
    recovery: float = 0.5
    speed_share: float = 0.25


class LegLengths:
    """Lengths of the legs, from landing to landing.

    Args:
        state: the robot at its posture, at rest.
        duration: of a step [s].
        settings: how they change.

    Attributes:
        lift: by how much the swing leg is drawn up [m]: as the settings say, or as far as its joints allow at the
            posture, in range and speed.
        stance: of the stance leg.
        swing: of the swing leg.
    """

    def __init__(self, state: SpaceState, duration: float, settings: LengthSettings) -> None:
        self.settings, self._duration = settings, duration
        length = state.lengths[Stance.LEFT]
        able = _able(state, settings, duration)
        self.lift, self._longest = able * settings.lift * length, able * settings.longest * length
        self._touchdown = able * settings.touchdown
        self._standing, self._swinging = MinimumJerk(), MinimumJerk()
        self.start(LegLength(), LegLength())

    def start(self, stance: LegLength, swing: LegLength) -> None:
        """A step begins: what both legs are longer than at the posture."""
        self._standing.start(stance.offset, stance.rate)
        self._swinging.start(swing.offset, swing.rate)
        self._since = 0.0
        self._take()

    def advance(self, left: float, period: float) -> None:
        """One control period on, with a time left to the landing [s]."""
        self._since += period
        recovering = self.settings.recovery * self._duration - self._since
        if recovering > 2.0 * period:
            self._standing.towards(0.0, recovering, period)
        else:
            self._standing.start(0.0, 0.0)
        rising = left - (1.0 - self.settings.highest) * self._duration
        swinging, touchdown = self._swinging, self._touchdown
        if not self.lift:
            swinging.start(0.0, 0.0)
        elif rising > 2.0 * period:
            swinging.towards(-self.lift, rising, period)
        elif left > 3.0 * period:
            swinging.towards(0.0, left, period, touchdown)
        else:
            swinging.coast(touchdown if swinging.x < self._longest else 0.0, period)
        self._take()

    def _take(self) -> None:
        self.stance, self.swing = (LegLength(leg.x, leg.dx, leg.ddx) for leg in (self._standing, self._swinging))


def _able(state: SpaceState, settings: LengthSettings, duration: float) -> float:
    """Share of the lift, from 0 to 1, that the leg's joints can do at the posture."""
    side, free = Stance.LEFT, state.free
    leg = np.array(free.leg(side))
    lift = settings.lift * state.lengths[side]
    if lift == 0.0:
        return 0.0
    foot = state.feet[side]
    rows = np.vstack([state.legs[side].J[LENGTH], state.legs[side].J[ANGLE], foot.J[X], foot.turning.J])[:, BASE + leg]
    try:
        turned = np.abs(np.linalg.solve(rows, np.eye(len(leg))[0]))  # of the joints, per metre
    except np.linalg.LinAlgError:  # straight legs
        return 0.0
    q, limits = free.posture[BASE + 1 + leg], free.limits
    room = np.minimum(q - limits.lower[leg], limits.upper[leg] - q)
    speed = PEAK * lift / (settings.highest * duration)
    with np.errstate(divide="ignore"):
        ables = np.minimum(room / (lift * turned), settings.speed_share * limits.velocity[leg] / (speed * turned))
    return float(np.clip(ables.min(), 0.0, 1.0))
