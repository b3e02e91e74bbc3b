"""How fast a robot falls from one foot to the other, step by step, beside the closed form.

Half-way down, since a soft contact still rings after an impact. The speed is that of the centre of mass sideways, half-
way along its falling phase: on gaits of least torque the ankle's angle runs over a few hundredths of a radian, and a
milliradian of output error changes its rate by a tenth while the robot moves as planned. Where the centre of mass turns
back along the phase it is the ankle's rate, half-way along its range.
"""

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.virtual_constraints.swayed import POINTS
from frontal_biped.zero_dynamics.orbit import resample


def speed_errors(biped: FrontalBiped, gait: Gait, run: Trajectory) -> FloatArray:
    """(n,) speed half-way down each falling phase, relative to the closed form, minus one [-].

    Steps that do not get there are left out; all of them where the gait's falling phase has no orbit.

    Args:
        biped: the robot.
        gait: what was walked.
        run: the walk.
    """
    step = gait.step(biped)
    orbit = resample(biped, gait.falling, step.falling, np.linspace(0.0, 1.0, POINTS))
    x, dx = _sway(biped, orbit.motion.q, orbit.motion.dq * orbit.dbeta[:, None])
    if not np.isfinite(dx).all():
        return np.empty(0)
    over_sway = bool((np.diff(x) > 0.0).all())
    if over_sway:
        middle = 0.5 * float(x[0] + x[-1])
        planned = float(np.sqrt(CubicSpline(x, dx**2)(middle)))
    else:
        half_way = resample(biped, gait.falling, step.falling, np.array([0.5**0.5, 1.0]))
        middle, planned = float(half_way.beta[0]), float(half_way.dbeta[0])
    errors = []
    for number in range(run.steps_completed):
        chosen = (run.step == number) & (run.phase < 0.0)
        q, dq = run.q[chosen], run.dq[chosen]
        x, dx = _sway(biped, q, dq) if over_sway else (q[:, 0], dq[:, 0])
        speed = _passing(run.t[chosen], x, dx, middle)
        if speed is not None:
            errors.append(speed / planned - 1.0)
    return np.array(errors)


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
