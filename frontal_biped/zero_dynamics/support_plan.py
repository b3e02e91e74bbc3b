r"""Motions along the double-support family: hand over from foot to foot, set off from rest, come to rest.

All of them are one closed form, a polynomial of degree 5 in time between two ends that give beta, dbeta and ddbeta.
At an end where one foot takes or has all of the weight, ddbeta is that of single support there, with the FRI on its
target: forces do not jump, and the foot to be lifted is unloaded exactly when it is lifted. At an end at rest it is
zero.

**Dead beat.** The end of a hand-over does not depend on its start: whatever speed the robot lands with, it lifts off
with the one that is planned. Only soles and motors bound what can be undone.

**Duration of a hand-over.** With ddbeta linear in beta between its ends' values a_0 and a_1, and a parabola with
coefficient c on top that makes up for what is missing (s runs from 0 to 1 over Delta),

.. math:: \tfrac12 \dot\beta^2 = \tfrac12 v_0^2 + \Delta \int_0^s (1 - x) a_0 + x a_1 + 6 c\, x (1 - x)\, dx, \qquad
          c = \frac{v_1^2 - v_0^2}{2 \Delta} - \frac{a_0 + a_1}{2},

and T = int Delta ds / dbeta: the time that the robot needs when the pressure point goes about evenly from foot to foot.

**Setting off.** From rest half-way the same polynomial first leans towards the foot that will swing, and comes back
with the speed of the orbit: nothing else can gain that speed, for the pressure point can only accelerate the centre of
mass away from itself. Coming to rest is the same, backwards: seen from the other foot, and with time reversed, the
double support of a gait is its own mirror image.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.exceptions import ReversalError, UnreachablePoseError
from frontal_biped.numerics.quintic import Kinematics, Quintic
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.zero_dynamics.support_dynamics import SupportLimits, SupportPoint

NODES, WEIGHTS = (np.array(part) for part in np.polynomial.legendre.leggauss(8))
"""Gauss's rule for the duration of a hand-over; with eight nodes it is exact to 1e-9 on the gaits tried."""


@dataclass(frozen=True)
class SupportPlan:
    """A motion along the family.

    Attributes:
        family: the poses.
        path: beta over time [rad].
    """

    family: DoubleSupportFamily
    path: Quintic

    @property
    def duration(self) -> float:
        """[s]."""
        return self.path.duration

    def at(self, t: float) -> Kinematics:
        """beta [rad], dbeta and ddbeta at time t [s]."""
        return self.path.at(t)

    def pressure_margin(self, count: int = 17) -> float:
        """How deep inside the ends of both feet the pressure point stays, at some instants [m]; -inf off the family."""
        outer = self.family.biped.sole[0]
        margins = []
        for t in np.linspace(0.0, self.duration, count).tolist():
            beta, speed, acceleration = self.at(t)
            try:
                p = SupportPoint.of(self.family, beta).pressure_point(acceleration, speed**2)
            except UnreachablePoseError:
                return -np.inf
            margins.append(min(p - outer, self.family.width - outer - p))
        return min(margins)

    def admissible(self, limits: SupportLimits, count: int = 9) -> bool:
        """Do soles and motors allow the motion, at ``count`` instants?"""
        return self.room(limits, count) >= 0.0

    def room(self, limits: SupportLimits, count: int = 9) -> float:
        """How far ddbeta stays inside what soles and motors allow, over half of that range; -inf where nothing is.

        One in the middle of the range, negative outside.
        """
        least = np.inf
        for t in np.linspace(0.0, self.duration, count).tolist():
            beta, speed, acceleration = self.at(t)
            allowed = SupportPoint.of(self.family, beta).acceleration_range(limits, speed**2)
            if allowed is None:
                return -np.inf
            low, high = allowed
            least = min(least, 2.0 * min(acceleration - low, high - acceleration) / (high - low))
        return float(least)


@dataclass(frozen=True)
class SingleSupportEnd:
    """Where double support meets single support.

    Attributes:
        beta: stance ankle angle [rad].
        p: where all of the weight acts, from the stance ankle [m].
    """

    beta: float
    p: float

    def kinematics(self, family: DoubleSupportFamily, speed: float) -> Kinematics:
        """The state there at a speed [rad/s], with the acceleration of single support."""
        acceleration = SupportPoint.of(family, self.beta).acceleration(self.p, speed**2)
        return Kinematics(self.beta, speed, acceleration)


@dataclass(frozen=True)
class HandOver:
    """The double support of a gait, in the coordinates of the foot that takes the weight.

    Attributes:
        family: the poses.
        landing: where the swing foot arrives.
        lift_off: where the other one leaves.
        speed: dbeta at lift-off [rad/s].
    """

    family: DoubleSupportFamily
    landing: SingleSupportEnd
    lift_off: SingleSupportEnd
    speed: float

    @classmethod
    def mirrored(cls, family: DoubleSupportFamily, lift_off: SingleSupportEnd, speed: float) -> "HandOver":
        """The one whose landing is the mirror image of its lift-off."""
        other = SingleSupportEnd(family.from_other_foot(lift_off.beta), family.width - lift_off.p)
        return cls(family, other, lift_off, speed)

    def plan(self, arrival: float | None = None, beta: float | None = None) -> SupportPlan:
        """The motion from a landing to the lift-off.

        Args:
            arrival: dbeta at the landing [rad/s]; default: that of the lift-off.
            beta: the stance ankle angle there [rad]; default: as planned.

        Raises:
            ReversalError: the robot lands so slowly, or so far on, that it would stop on the way.
        """
        arrival = self.speed if arrival is None else arrival
        landing = self.landing if beta is None else SingleSupportEnd(beta, self.landing.p)
        start = landing.kinematics(self.family, arrival)
        end = self.lift_off.kinematics(self.family, self.speed)
        return SupportPlan(self.family, Quintic.between(start, end, natural_duration(start, end)))

    def setting_off(self, beta: float, duration: float) -> SupportPlan:
        """From rest at beta [rad] to the lift-off, in a time [s]."""
        end = self.lift_off.kinematics(self.family, self.speed)
        return SupportPlan(self.family, Quintic.between(Kinematics(beta, 0.0, 0.0), end, duration))

    def coming_to_rest(
        self, beta: float, duration: float, arrival: float | None = None, landed: float | None = None
    ) -> SupportPlan:
        """From a landing to rest at beta [rad], in a time [s]; ``arrival`` and ``landed`` as those of `plan`."""
        landing = self.landing if landed is None else SingleSupportEnd(landed, self.landing.p)
        start = landing.kinematics(self.family, self.speed if arrival is None else arrival)
        return SupportPlan(self.family, Quintic.between(start, Kinematics(beta, 0.0, 0.0), duration))


def natural_duration(start: Kinematics, end: Kinematics) -> float:
    """Time from one end to the other with ddbeta a parabola over beta [s]: see the module.

    Raises:
        ReversalError: the robot would stop on the way.
    """
    s = 0.5 * (NODES + 1.0)
    Delta, v_0, v_1 = end.x - start.x, start.dx, end.dx
    if Delta <= 0.0:
        raise ReversalError(f"the landing at {start.x:.4g} rad is not before the lift-off at {end.x:.4g} rad")
    c = (v_1**2 - v_0**2) / (2.0 * Delta) - 0.5 * (start.ddx + end.ddx)
    work = start.ddx * (s - 0.5 * s**2) + 0.5 * end.ddx * s**2 + c * (3.0 - 2.0 * s) * s**2
    speed_squared = v_0**2 + 2.0 * Delta * work
    if v_0 <= 0.0 or np.any(speed_squared <= 0.0):
        raise ReversalError(f"landed at {v_0:.4g} rad/s, the robot stops before it lifts off; it must land faster")
    return float(0.5 * WEIGHTS @ (Delta / np.sqrt(speed_squared)))


def rest_to_rest(family: DoubleSupportFamily, start: float, end: float, duration: float) -> SupportPlan:
    """From rest to rest, stance ankle angles [rad], in a time [s]."""
    path = Quintic.between(Kinematics(start, 0.0, 0.0), Kinematics(end, 0.0, 0.0), duration)
    return SupportPlan(family, path)
