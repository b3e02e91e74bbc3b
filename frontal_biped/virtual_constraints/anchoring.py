r"""Reversal-adaptive invariance: phases that begin where the robot is, not where it was planned to be.

**A reversal later than planned.** Beyond s = 1 the rising polynomial is useless (on the reference gait I_P vanishes
within 1.3e-3 rad), so it is continued, with x = beta - beta_r- and lengths l,

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

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.virtual_constraints.bezier import bernstein, bernstein_derivative, restrict
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase

REJOIN = 2.0
"""c: length over which an early falling phase rejoins its path, relative to how early it is."""

SAME = 1e-9
"""[rad] a reversal this near to the planned one is the planned one."""


@dataclass(frozen=True)
class ContinuedPhase(Phase):
    """A rising phase that goes on smoothly past its planned end.

    Attributes:
        taper: length l over which slopes die out past the end [rad].
        curvature_taper: length m over which the curvature at the end dies out [rad].
        fri_taper: length over which the slope of the FRI target dies out [rad].
        shift: what `shifted_fri` has added to the FRI target [m].
    """

    taper: float
    curvature_taper: float
    fri_taper: float
    shift: float = 0.0

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the virtual constraints change form [rad]."""
        return (self.beta_end,)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad], past the end on the continuation."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        late = beta > self.beta_end
        at = super().motion(np.minimum(beta, self.beta_end))
        if not np.any(late):
            return at
        x = (beta[late] - self.beta_end)[:, None]
        l, m = self.taper, self.curvature_taper
        slow, fast = np.exp(-x / l), np.exp(-x / m)
        q, dq, ddq, p_fri, dp_fri = (part.copy() for part in at)
        slope, growth = dq[late, 1:], ddq[late, 1:] + dq[late, 1:] / l
        q[:, 0] = beta
        q[late, 1:] += slope * l * (1.0 - slow) + growth * m * (m - (m + x) * fast)
        dq[late, 1:] = slope * slow + growth * x * fast
        ddq[late, 1:] = growth * (1.0 - x / m) * fast - slope / l * slow
        decay = np.exp(-x[:, 0] / self.fri_taper)
        p_fri[late] += dp_fri[late] * self.fri_taper * (1.0 - decay)
        dp_fri[late] *= decay
        return ConstrainedMotion(q, dq, ddq, p_fri, dp_fri)

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta."""
        return super().desired(beta) if beta <= self.beta_end else _at_one(self.motion(np.array([beta])))


@dataclass(frozen=True)
class AnchoredFallingPhase(Phase):
    """A falling phase that begins at an actual reversal: retracing above the planned one, rejoining below it.

    The fields of `Phase` are the planned ones.

    Attributes:
        begin: the actual reversal [rad].
        join: below it the phase is the planned one [rad].
        mismatch: (3, 2) pose and slope of q_b at ``begin`` minus the planned ones [rad, -].
        fri_mismatch: FRI target at ``begin`` minus the planned one [m].
        retraced: the rising phase, followed back where the reversal is late; None where it is early.
    """

    begin: float
    join: float
    mismatch: FloatArray
    fri_mismatch: float
    retraced: Phase | None

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the virtual constraints change form [rad]."""
        return (self.join if self.retraced is None else self.beta_start,)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad]."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        q, dq, ddq, p_fri, dp_fri = (part.copy() for part in super().motion(beta))
        above = beta > (self.join if self.retraced is None else self.beta_start)
        if np.any(above) and self.retraced is not None:
            back = self.retraced.motion(beta[above])
            q[above], dq[above], ddq[above], p_fri[above], dp_fri[above] = back
        elif np.any(above):
            length = self.begin - self.join
            x = (beta[above] - self.join) / length
            columns = self._correction(length)
            p_fri[above] += self.fri_mismatch * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
            dp_fri[above] += self.fri_mismatch * 30.0 * x**2 * (1.0 - x) ** 2 / length
            q[above, 1:] += bernstein(5, x) @ columns.T
            dq[above, 1:] += bernstein_derivative(5, x, 1) @ columns.T / length
            ddq[above, 1:] += bernstein_derivative(5, x, 2) @ columns.T / length**2
        return ConstrainedMotion(q, dq, ddq, p_fri, dp_fri)

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta."""
        if beta <= (self.join if self.retraced is None else self.beta_start):
            return super().desired(beta)
        return self.retraced.desired(beta) if self.retraced is not None else _at_one(self.motion(np.array([beta])))

    def _correction(self, length: float) -> FloatArray:
        """(3, 6) Bezier columns over x in [0, 1]: zero with two derivatives at 0, the mismatch at 1, flat curvature."""
        value, slope = self.mismatch[:, 0], self.mismatch[:, 1] * length
        zero = np.zeros(3)
        return np.stack([zero, zero, zero, value - 0.4 * slope, value - 0.2 * slope, value], axis=1)


def _at_one(at: ConstrainedMotion) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    return at.q[0, 1:], at.dq[0, 1:], at.ddq[0, 1:], float(at.p_fri[0])


def continued(
    phase: Phase, taper: float, curvature_taper: float | None = None, fri_taper: float | None = None
) -> ContinuedPhase:
    """A rising phase with its continuation past s = 1; the other lengths are ``taper`` by default [rad]."""
    curvature = taper if curvature_taper is None else curvature_taper
    fri = taper if fri_taper is None else fri_taper
    return ContinuedPhase(phase.beta_start, phase.beta_end, phase.joint_bezier, phase.fri_bezier, taper, curvature, fri)


def stretched(phase: ContinuedPhase, end: float) -> ContinuedPhase:
    """A rising phase that reaches its final pose at another beta [rad]; pose and slope at its start stay."""
    M = phase.degree
    columns = phase.joint_bezier.copy()
    columns[:, 1] = columns[:, 0] + (columns[:, 1] - columns[:, 0]) * (end - phase.beta_start) / phase.range
    assert M >= 3  # or column 1 would be the last but one
    return replace(phase, beta_end=end, joint_bezier=columns)


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
    if beta > planned.beta_start:
        s = (beta - planned.beta_start) / planned.range
        joints, fri = restrict(planned.joint_bezier, s), restrict(planned.fri_bezier, s)
        planned = replace(planned, beta_start=beta, joint_bezier=joints, fri_bezier=fri)
    moved = with_ends(planned, beta, pose, slope, planned.beta_end, planned.joint_bezier[:, -1])
    return replace(planned, beta_start=moved.beta_start, joint_bezier=moved.joint_bezier)


def anchored_falling(planned: Phase, rising: Phase, reversal: float, rejoin: float = REJOIN) -> Phase:
    """The falling phase from an actual reversal of the rising phase.

    Args:
        planned: the falling phase; it starts where the rising phase was planned to end, in pose, slope and FRI.
        rising: the rising phase that has just ended.
        reversal: where it reversed [rad].
        rejoin: c, at most what takes it to the impact.
    """
    early = planned.beta_start - reversal
    at = np.array([min(reversal, planned.beta_start)])
    actual, path = rising.motion(at), planned.motion(at)
    fri_mismatch = float(actual.p_fri[0] - path.p_fri[0])
    if abs(early) <= SAME:
        return planned
    begin = float(at[0])
    if early <= SAME:
        mismatch, length, retraced = np.zeros((3, 2)), 0.0, rising
    else:
        mismatch, retraced = _row(actual) - _row(path), None
        length = min(rejoin * early, reversal - planned.beta_end)
    return AnchoredFallingPhase(
        planned.beta_start,
        planned.beta_end,
        planned.joint_bezier,
        planned.fri_bezier,
        max(reversal, begin),
        reversal - length,
        mismatch,
        fri_mismatch if retraced is None else 0.0,
        retraced,
    )


def rescaled_falling(planned: Phase, rising: Phase, start: float) -> Phase:
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


def shifted_fri(phase: Phase, shift: float) -> Phase:
    """The phase with its FRI target moved by a constant [m]."""
    moved = replace(phase, fri_bezier=phase.fri_bezier + shift)
    if isinstance(moved, ContinuedPhase):
        return replace(moved, shift=moved.shift + shift)
    if isinstance(moved, AnchoredFallingPhase) and moved.retraced is not None:
        return replace(moved, retraced=shifted_fri(moved.retraced, shift))
    return moved


def unshifted(phase: Phase) -> Phase:
    """A rising phase without what `shifted_fri` has added."""
    return shifted_fri(phase, -phase.shift) if isinstance(phase, ContinuedPhase) and phase.shift else phase
