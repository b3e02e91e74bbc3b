r"""Reversal-adaptive invariance: phases that begin where the robot is, not where it was planned to be.

**A reversal later than planned.** Beyond s = 1 the rising polynomial is useless (on the reference gait I_P vanishes
within 1.52e-3 rad), so it is continued, with x = beta - beta_r- and lengths l,

.. math:: h_d'(x) = h' e^{-x/\ell} + (h'' + h'/\ell) x e^{-x/m}, \qquad p'(x) = p' e^{-x/\ell_p}

value, slope and curvature meeting those at s = 1 (the FRI target: value and slope, all that enters the dynamics). The
joints come to rest within a few l and the robot turns about its ankle as one body. The falling phase *retraces* that
continuation down to beta_r- and goes on as planned. On the way back every integrand is the same function of beta, so
beta_r- is passed with the energy it was passed with on the way up: the return map stays the affine map rho of [O] eq.
pcc, for every late reversal, exactly.

**A reversal earlier than planned**, at beta_a = beta_r- - d. The falling phase starts in the pose and with the slope of
the rising one and *rejoins* its own path h_f over a length proportional to d:

.. math:: h_d(\beta) = h_f(\beta) + e(\beta), \quad e, e' = \text{the mismatch at } \beta_a, \quad
          e = e' = e'' = 0 \text{ at and below } \beta_a - \lambda, \quad \lambda = \min(c\, d, \text{the way left}).

Pose and slope of both phases agree at beta_r-, so the mismatch is of order d^2 in pose and d in slope, and lasts for a
length of order d: its effect on the energy is of second order. The FRI target likewise. The slope of the return map at
the gait is therefore the multiplier, from this side too. The state stays on Z at every reversal point, and the pose of
the impact is as planned.

**A landing that was disturbed.** The rising phase is anchored to the actual pose and slope (columns 0 and 1) and keeps
its end in pose and slope.
"""

from dataclasses import replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.virtual_constraints.bezier import restrict
from frontal_biped.virtual_constraints.contract import VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase
from frontal_biped.virtual_constraints.piecewise import ContinuedPhase, RejoiningPhase, RetracingPhase

REJOIN = 2.0
"""c: length over which an early falling phase rejoins its path, relative to how early it is."""

SAME = 1e-9
"""[rad] a reversal this near to the planned one is the planned one."""


def continued(
    phase: Phase, taper: float, curvature_taper: float | None = None, fri_taper: float | None = None
) -> ContinuedPhase:
    """A rising phase with its continuation past s = 1; the other lengths are ``taper`` by default [rad]."""
    curvature = taper if curvature_taper is None else curvature_taper
    fri = taper if fri_taper is None else fri_taper
    return ContinuedPhase(phase, taper, curvature, fri)


def anchored_rising(planned: ContinuedPhase, beta: float, pose: FloatArray, slope: FloatArray) -> ContinuedPhase:
    """The rising phase from an actual state; it keeps its end in pose and slope.

    Begun on its way, it is what is left of the planned one, plus a correction of pose and slope that dies out towards
    the end: where there is nothing to correct it goes on as if nothing had happened.

    Args:
        planned: the rising phase.
        beta: actual stance ankle angle [rad].
        pose: (3,) actual q_b [rad].
        slope: (3,) actual dq_b/dbeta [-].
    """
    phase = planned.phase
    if beta > phase.beta_start:
        s = (beta - phase.beta_start) / phase.range
        phase = Phase(beta, phase.beta_end, restrict(phase.joint_bezier, s), restrict(phase.fri_bezier, s))
    return replace(planned, phase=with_ends(phase, beta, pose, slope, phase.beta_end, phase.joint_bezier[:, -1]))


def anchored_falling(
    planned: Phase, rising: VirtualConstraints, reversal: float, rejoin: float = REJOIN
) -> VirtualConstraints:
    """The falling phase from an actual reversal of the rising phase.

    Args:
        planned: the falling phase; it starts where the rising phase was planned to end, in pose, slope and FRI.
        rising: the rising phase that has just ended.
        reversal: where it reversed [rad].
        rejoin: c, at most what takes it to the impact.
    """
    early = planned.beta_start - reversal
    if abs(early) <= SAME:
        return planned
    if early < 0.0:
        return RetracingPhase(planned, rising)
    at = np.array([reversal])
    actual, path = rising.motion(at), planned.motion(at)
    mismatch = _row(actual) - _row(path)
    join = reversal - min(rejoin * early, reversal - planned.beta_end)
    return RejoiningPhase(planned, reversal, join, mismatch, float(actual.p_fri[0] - path.p_fri[0]))


def rescaled_falling(planned: Phase, rising: VirtualConstraints, start: float) -> Phase:
    """The falling phase rescaled as a whole to begin on the rising one, its end kept in pose and slope.

    Gentler than rejoining: nothing is bent within a length proportional to how early the reversal is. But the path to
    the impact is another one, and with it the slope of the return map on this side: 1.1 instead of the multiplier of
    0.76 on the reference gait. Something else must then see to the energy.

    Args:
        planned: the falling phase.
        rising: the rising phase that has just ended.
        start: where the falling phase begins [rad].
    """
    at = rising.motion(np.array([start]))
    end = planned.beta_end, planned.joint_bezier[:, -1]
    return with_ends(planned, start, at.q[0, 1:], at.dq[0, 1:], *end, float(at.p_fri[0]), spread=True)


def _row(at: ConstrainedMotion) -> FloatArray:
    return np.stack([at.q[0, 1:], at.dq[0, 1:]], axis=1)


def with_ends(
    phase: Phase,
    start: float,
    start_pose: FloatArray,
    start_slope: FloatArray,
    end: float,
    end_pose: FloatArray,
    start_fri: float | None = None,
    spread: bool = False,
) -> Phase:
    """The phase with other ends: columns 0, 1 and M are given, M - 1 keeps the final slope, the rest follow.

    Args:
        phase: the phase.
        start: beta at its start [rad].
        start_pose: (3,) q_b there [rad].
        start_slope: (3,) dq_b/dbeta there [-].
        end: beta at its end [rad].
        end_pose: (3,) q_b there [rad].
        start_fri: FRI target at the start [m]; default: the phase's own.
        spread: let the inner columns follow the start as well, the nearer the more, instead of staying where they are?
    """
    M = phase.degree
    length = end - start
    old = phase.joint_bezier
    final_slope = M * (old[:, -1] - old[:, -2]) / phase.range
    # the inner columns move with the end, the nearer the more
    columns = old + (end_pose - old[:, -1])[:, None] * (np.arange(M + 1) / M) ** 2
    if spread:
        columns += (start_pose - old[:, 0])[:, None] * (1.0 - np.arange(M + 1) / M)
    columns[:, -1] = end_pose
    columns[:, -2] = end_pose - final_slope * length / M
    columns[:, 0] = start_pose
    columns[:, 1] = start_pose + start_slope * length / M
    fri = phase.fri_bezier.copy()
    if start_fri is not None:
        fri[0] = start_fri
    return Phase(start, end, columns, fri)
