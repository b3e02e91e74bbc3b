r"""What is shown of a gait with a finite double support: it keeps its bounds, lands at rest, and forgets errors.

*No impact.* The rigid impact at the end of the falling phase takes nothing: the impulse per unit of the robot's
momentum is zero to rounding.

*Return map.* With zeta about the pressure point p, continuous from foot to foot, dzeta/dbeta = drive + rate zeta with
rate = -2 p' m p_cm_v' / I_P (`zero_dynamics.restricted`). Rising and falling take the same curve, so what is left of a
step is the double support: with p over beta as planned the slope of the map is

.. math:: \exp \int -2\, p'\, m p_{cm,v}' / I_P \; d\beta \approx 1,

for p' is the same, and the slope of the height the opposite, on both sides of half-way: neutral. (It would be one
exactly if the plan were its own mirror image; a polynomial in beta seen from one foot is not quite one seen from the
other.) With dead beat the
lift-off does not depend on the arrival: the slope is zero, for every arrival between the slowest and the fastest whose
hand-over soles and motors allow.
"""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.support_constraints import SupportStep, evaluate_support_step, margins
from frontal_biped.gait.support_gait import SupportGait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import impact
from frontal_biped.zero_dynamics.restricted import F_V, N_0
from frontal_biped.zero_dynamics.support_dynamics import SupportPoint
from frontal_biped.zero_dynamics.support_plan import HandOver, SupportPlan

DENSE = 60
"""Quadrature nodes on which the bounds are checked."""

SLOWEST, FASTEST = 0.3, 2.0
"""Arrivals that are looked at, over the orbit's."""

RESOLUTION = 0.01
"""Of their ends."""

DEGREE = 24
"""Of the Chebyshev polynomial of the pressure point over time."""


STORED = 1e-9
"""What stored numbers may be off from new ones, relative: another order of summation, no more."""


@dataclass(frozen=True)
class SupportCertificate:
    """What was found.

    Attributes:
        margin: least scaled margin of the bounds on dense nodes; >= 0 where all are kept.
        impulse: of the rigid impact at the landing, over the momentum of the robot's centre of mass [-].
        slope: of the return map without dead beat [-].
        arrivals: slowest and fastest dbeta at a landing that dead beat undoes, over the orbit's [-].
        room: least distance of ddbeta from what soles and motors allow on the orbit's hand-over (`SupportPlan.room`).
        standing_room: the same on the way from rest to the lift-off and from a landing to rest.
        stored_orbit: largest relative difference of speed and numbers that the gait tells from new ones [-].
    """

    margin: float
    impulse: float
    slope: float
    arrivals: tuple[float, float]
    room: float
    standing_room: float
    stored_orbit: float = 0.0

    @property
    def holds(self) -> bool:
        """Bounds kept, everything admissible, and arrivals on both sides of the orbit's undone."""
        low, high = self.arrivals
        kept = min(self.margin, self.room, self.standing_room) >= 0.0
        return kept and low < 1.0 < high and self.stored_orbit <= STORED

    def __str__(self) -> str:
        low, high = self.arrivals
        return (
            f"least margin of the bounds   {self.margin:.3g} (scaled)\n"
            f"impulse of the landing       {self.impulse:.1e} of the momentum\n"
            f"slope of the return map      0 with dead beat, {self.slope:.5f} without\n"
            f"arrivals that are undone     {low:.3g} to {high:.3g} of the orbit's speed\n"
            f"room of the hand-over        {self.room:.3g}\n"
            f"room from and to standing    {self.standing_room:.3g}\n"
            f"stored orbit is off by       {self.stored_orbit:.1e}"
        )

    @property
    def line(self) -> str:
        """The verdict in one line."""
        low, high = self.arrivals
        return (
            f"{'certified' if self.holds else 'not certified'}; lands with {self.impulse:.0e} of the momentum, arrivals"
            f" at {low:.3g} to {high:.3g} of the orbit's speed are undone in one double support"
        )

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"certified": self.holds, **asdict(self)}


def certify_support_gait(biped: FrontalBiped, gait: SupportGait) -> SupportCertificate:
    """Check a gait on dense nodes.

    Raises:
        ReversalError: the gait has no orbit.
        UnreachablePoseError: its double support leaves the family.
        GaitFileError: the gait is of another robot.
    """
    step, over = evaluate_support_step(biped, gait, DENSE), gait.hand_over(biped)
    limits = gait.limits(biped)
    motion = step.orbit.motion
    landing = impact(biped, motion.q[-1], -motion.dq[-1])
    momentum = biped.mass * np.linalg.norm(biped.com_velocity(motion.q[-1], motion.dq[-1]))
    half_way = over.family.half_way()
    ways = (over.setting_off(half_way, gait.setting_off), over.coming_to_rest(half_way, gait.setting_off))
    return SupportCertificate(
        float(margins(step.constraints).min()),
        float(np.linalg.norm(landing.impulse[:2]) / momentum),
        slope_without_dead_beat(over.plan()),
        (_farthest(gait, biped, over, SLOWEST), _farthest(gait, biped, over, FASTEST)),
        over.plan().room(limits),
        min(way.room(limits, 17) for way in ways),
        _stored_orbit(gait, step),
    )


def _stored_orbit(gait: SupportGait, step: SupportStep) -> float:
    """Relative difference of what the gait tells of its orbit from the step just evaluated."""
    pairs = [(gait.speed, float(step.orbit.dbeta[-1]))]
    if gait.numbers is not None:
        pairs += zip(gait.numbers, (step.duration, step.hand_over.duration, step.cost), strict=True)
    return max(abs(told / new - 1.0) for told, new in pairs)


def slope_without_dead_beat(plan: SupportPlan) -> float:
    """Of the map of zeta through a double support whose pressure point is the plan's over beta [-]."""
    nodes, weights = np.polynomial.legendre.leggauss(DEGREE)
    T = plan.duration

    def dynamics(t: float) -> tuple[float, float, float]:
        """Pressure point, and I_P and m p_cm_v' with respect to it."""
        beta, speed, acceleration = plan.at(t)
        point = SupportPoint.of(plan.family, beta)
        p = point.pressure_point(acceleration, speed**2)
        return p, float(point.A[N_0] - p * point.A[F_V]), float(point.A[F_V])

    p, I_P, height = np.array([dynamics(0.5 * T * (x + 1.0)) for x in nodes.tolist()]).T
    dp = chebyshev.chebval(nodes, chebyshev.chebder(chebyshev.chebfit(nodes, p, DEGREE - 1)))
    return float(np.exp(weights @ (-2.0 * dp * height / I_P)))


def _farthest(gait: SupportGait, biped: FrontalBiped, over: HandOver, end: float) -> float:
    """Bisection between the orbit's arrival and ``end``, both relative, for the last that can be undone."""
    limits = gait.limits(biped)

    def undone(arrival: float) -> bool:
        try:
            return over.plan(arrival * gait.speed).admissible(limits)
        except ReversalError:
            return False

    if undone(end):
        return end
    good, bad = 1.0, end
    while abs(bad - good) > RESOLUTION:
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if undone(middle) else (good, middle)
    return good
