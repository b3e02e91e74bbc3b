r"""A step whose rising phase is stretched and reverses at its end, in balls.

What `half_steps.stretch_to_reversal` and `anchoring.with_ends` make of a planned step: the rising phase takes the same
poses in the same order, the last one e past the planned reversal; pose and slope at its start stay, as in
`Phase.stretched`. The falling phase begins there, in that pose and with that slope, and keeps pose and slope at its
end. With Delta the range of a phase, columns counted from its start, r of the rising phase and c of the falling one,
M_r and M their degrees:

.. math:: r_1 := r_0 + (r_1 - r_0) \frac{\Delta_r + e}{\Delta_r}, \qquad
          c_1 := c_0 + (r_{M_r} - r_{M_r - 1}) \frac{M_r}{M} \frac{\Delta_f - e}{\Delta_r + e}, \qquad
          c_{M-1} := c_M + (c_{M-1} - c_M) \frac{\Delta_f - e}{\Delta_f},

Delta_f negative; all other columns, those of the FRI target among them, are as planned. So is the impact.

The energy zeta is that of a momentum, and does not depend on the variable the step is described by. By one that takes
the planned ranges, whatever e is, a ball of many e stays out of every slope (`over_ranges_of`).
"""

from dataclasses import replace
from itertools import pairwise

from frontal_biped.zero_dynamics.proof.ball_gait import BallStep, half_step
from frontal_biped.zero_dynamics.proof.balls import Ball, Number, arb
from frontal_biped.zero_dynamics.proof.half_step import Curve, HalfStep, NotEnclosedError

LEAST_DEGREE = 3
"""Of the joints: below, columns at the two ends are the same."""


def stretched(step: BallStep, begin: Ball, end: Ball, e: Ball) -> BallStep:
    """A step that reverses e [rad] later, in the pose of the planned reversal.

    Args:
        step: as planned.
        begin: beta after the impact [rad].
        end: beta at the impact [rad].
        e: how much later [rad]; a ball is all steps between.

    Raises:
        NotEnclosedError: the joints' polynomials are of too low a degree.
    """
    rising, falling = step.rising, step.falling
    up, down = rising.span + e, falling.span + e
    # both halves are kept from the impact to the reversal
    joints_r, joints_f = joint_columns(rising), joint_columns(falling)
    M_r, M = len(joints_r[0]) - 1, len(joints_f[0]) - 1
    if min(M_r, M) < LEAST_DEGREE:
        raise NotEnclosedError("degree")
    for r, c in zip(joints_r, joints_f, strict=True):
        r[1] = r[0] + (r[1] - r[0]) * (up / rising.span)
        c[1] = c[0] + (c[1] - c[0]) * (down / falling.span)
        c[-2] = c[-1] - (r[-1] - r[-2]) * arb(M_r) / M * (down / up)
    return BallStep(
        half_step(rising.chain, begin, up, joints_r, list(rising.fri.columns)),
        half_step(falling.chain, end, down, joints_f, list(falling.fri.columns)),
        step.speed_ratio,
    )


def over_ranges_of(planned: BallStep, step: BallStep) -> BallStep:
    """A step by variables that take the ranges of the halves of another one, in place of beta."""
    return replace(
        step,
        rising=_over(planned.rising.span, step.rising),
        falling=_over(planned.falling.span, step.falling),
    )


def _over(span: Number, half: HalfStep) -> HalfStep:
    angles = tuple(Curve.of(list(angle.columns), span) for angle in half.angles)
    return replace(half, span=span, angles=angles, fri=Curve.of(list(half.fri.columns), span))


def joint_columns(half: HalfStep) -> list[list[Number]]:
    """Bezier columns of the three joints after the first, from those of the links' absolute angles [rad]."""
    quarter = arb.pi() / 2
    links = [curve.columns for curve in half.angles]
    return [[b - a - quarter for a, b in zip(*pair, strict=True)] for pair in pairwise(links)]
