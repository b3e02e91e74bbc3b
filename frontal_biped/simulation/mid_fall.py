"""How fast a robot falls from one foot to the other, step by step, beside the closed form.

Half-way down, since a soft contact still rings after an impact. The speed is that of the centre of mass sideways, half-
way along its falling phase: on gaits of least torque the ankle's angle runs over a few hundredths of a radian, and a
milliradian of output error changes its rate by a tenth while the robot moves as planned. Where the centre of mass turns
back along the phase it is the ankle's rate, half-way along its range.
"""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.sideways import AnyGait, orbits_in_turn, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.virtual_constraints.swayed import POINTS
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, resample


def speed_errors(biped: FrontalBiped, gait: AnyGait, run: Trajectory) -> FloatArray:
    """(n,) speed half-way down each falling phase, relative to the closed form, minus one [-].

    Steps that do not get there are left out; all of them where a falling phase of the gait has no orbit.

    Args:
        biped: the robot.
        gait: what was walked, from its first step on.
        run: the walk.
    """
    planned = [
        _HalfWay.of(biped, step.falling, orbit.falling)
        for step, orbit in zip(steps_in_turn(gait), orbits_in_turn(biped, gait), strict=True)
    ]
    if not all(np.isfinite(half_way.speed) for half_way in planned):
        return np.empty(0)
    errors = []
    for number in range(run.steps_completed):
        at = planned[number % len(planned)]
        chosen = (run.step == number) & (run.phase < 0.0)
        q, dq = run.q[chosen], run.dq[chosen]
        x, dx = _sway(biped, q, dq) if at.over_sway else (q[:, 0], dq[:, 0])
        speed = _passing(run.t[chosen], x, dx, at.place)
        if speed is not None:
            errors.append(speed / at.speed - 1.0)
    return np.array(errors)


class _HalfWay(NamedTuple):
    """The middle of a falling phase as planned.

    Attributes:
        over_sway: is it one of the sway, or of beta?
        place: where [m] or [rad].
        speed: there [m/s] or [rad/s].
    """

    over_sway: bool
    place: float
    speed: float

    @classmethod
    def of(cls, biped: FrontalBiped, falling: Phase, planned: PhaseOrbit) -> "_HalfWay":
        orbit = resample(biped, falling, planned, np.linspace(0.0, 1.0, POINTS))
        x, dx = _sway(biped, orbit.motion.q, orbit.motion.dq * orbit.dbeta[:, None])
        if not np.isfinite(dx).all():
            return cls(over_sway=True, place=float("nan"), speed=float("nan"))
        if (np.diff(x) > 0.0).all():
            middle = 0.5 * float(x[0] + x[-1])
            return cls(over_sway=True, place=middle, speed=float(np.sqrt(CubicSpline(x, dx**2)(middle))))
        half_way = resample(biped, falling, planned, np.array([0.5**0.5, 1.0]))
        return cls(over_sway=False, place=float(half_way.beta[0]), speed=float(half_way.dbeta[0]))


def _sway(biped: FrontalBiped, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n,) sway [m] and its rate [m/s] at q, dq (n, 4)."""
    rates = [biped.com_velocity(*state)[0] for state in zip(q, dq, strict=True)]
    return np.array([biped.com(row)[0] for row in q]), np.array(rates)


def _passing(t: FloatArray, x: FloatArray, dx: FloatArray, middle: float) -> float | None:
    """Rate of x the last time it passes a value; None where it never does."""
    apart = np.append(np.diff(t) > 0.0, True)  # an event is two samples at one time
    if np.count_nonzero(apart) < 2:
        return None
    way = CubicHermiteSpline(t[apart], x[apart], dx[apart])
    passed = way.solve(middle, extrapolate=False)
    return float(way(passed[-1], 1)) if len(passed) else None
