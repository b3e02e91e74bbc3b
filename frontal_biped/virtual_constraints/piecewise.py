"""Virtual constraints in pieces: a phase as planned, and beside it what goes on, comes back or dies out.

`anchoring` derives these and says when which of them is taken. Each keeps the planned phase and asks it where it holds.
"""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.virtual_constraints.bezier import bernstein, bernstein_derivative
from frontal_biped.virtual_constraints.contract import VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase

REACH = 0.5
"""How far past its end a rising phase is followed [rad]."""

PAST_END = (0.25, 1.0, 3.0)
"""Panels of the continuation, in units of its taper."""


@dataclass(frozen=True)
class _Wrapper:
    """Keeps a phase, and the ends it was planned with.

    Attributes:
        phase: what is wrapped.
    """

    phase: Phase

    @property
    def beta_start(self) -> float:
        """Beta at the start of the phase as planned [rad]."""
        return self.phase.beta_start

    @property
    def beta_end(self) -> float:
        """Beta at its end as planned [rad]."""
        return self.phase.beta_end

    @property
    def range(self) -> float:
        """beta_end - beta_start [rad], negative when falling."""
        return self.phase.range


@dataclass(frozen=True)
class ContinuedPhase(_Wrapper):
    """A rising phase that goes on smoothly past its planned end.

    Attributes:
        phase: the rising phase up to its end.
        taper: length l over which slopes die out past the end [rad].
        curvature_taper: length m over which the curvature at the end dies out [rad].
        fri_taper: length over which the slope of the FRI target dies out [rad].
        shift: what `shifted` has added to the FRI target [m].
    """

    taper: float
    curvature_taper: float
    fri_taper: float
    shift: float = 0.0

    @property
    def breaks(self) -> tuple[float, ...]:
        """The end, where the continuation begins [rad]."""
        return (self.beta_end,)

    @property
    def past_end(self) -> tuple[float, ...]:
        """The end; panels as long as what dies out on them; and `REACH` beyond [rad]."""
        short, taper = self.curvature_taper, self.taper
        panels = [self.beta_end + x for f in PAST_END for x in (f * short, 3.0 * short + f * taper)]
        return (self.beta_end, *panels, max(panels) + REACH)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad], past the end on the continuation."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        late = beta > self.beta_end
        at = self.phase.motion(np.minimum(beta, self.beta_end))
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
        phase = self.phase
        return phase.desired(beta) if beta <= phase.beta_end else _at_one(self.motion(np.array([beta])))

    def shifted(self, shift: float) -> "ContinuedPhase":
        """The phase with its FRI target moved by a constant [m]."""
        return replace(self, phase=self.phase.shifted(shift), shift=self.shift + shift)

    def unshifted(self) -> "ContinuedPhase":
        """The phase without what `shifted` has added."""
        return self.shifted(-self.shift) if self.shift else self

    def stretched(self, end: float) -> "ContinuedPhase":
        """The phase that reaches its final pose at another beta [rad], its continuation as it was."""
        return replace(self, phase=self.phase.stretched(end))


@dataclass(frozen=True)
class RetracingPhase(_Wrapper):
    """A falling phase from a late reversal: the rising one followed back to where the planned one begins.

    Attributes:
        phase: the planned falling phase.
        rising: the phase that reversed.
    """

    rising: VirtualConstraints

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the planned phase takes over [rad]."""
        return (self.beta_start,)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad]."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        motion = ConstrainedMotion(*(part.copy() for part in self.phase.motion(beta)))
        above = beta > self.beta_start
        if np.any(above):
            for part, back in zip(motion, self.rising.motion(beta[above]), strict=True):
                part[above] = back
        return motion

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta."""
        phase = self.phase
        return phase.desired(beta) if beta <= phase.beta_start else self.rising.desired(beta)

    def shifted(self, shift: float) -> "RetracingPhase":
        """The phase with its FRI target moved by a constant [m], on the way back as well."""
        return RetracingPhase(self.phase.shifted(shift), self.rising.shifted(shift))


@dataclass(frozen=True)
class RejoiningPhase(_Wrapper):
    """A falling phase from an early reversal: the planned one plus a mismatch that dies out.

    Attributes:
        phase: the planned falling phase.
        begin: the actual reversal [rad].
        join: below it the phase is the planned one [rad].
        mismatch: (3, 2) pose and slope of q_b at ``begin`` minus the planned ones [rad, -].
        fri_mismatch: FRI target at ``begin`` minus the planned one [m].
    """

    begin: float
    join: float
    mismatch: FloatArray
    fri_mismatch: float

    @property
    def breaks(self) -> tuple[float, ...]:
        """Where the mismatch has died out [rad]."""
        return (self.join,)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad]."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        q, dq, ddq, p_fri, dp_fri = (part.copy() for part in self.phase.motion(beta))
        above = beta > self.join
        if np.any(above):
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
        return self.phase.desired(beta) if beta <= self.join else _at_one(self.motion(np.array([beta])))

    def shifted(self, shift: float) -> "RejoiningPhase":
        """The phase with its FRI target moved by a constant [m]."""
        return replace(self, phase=self.phase.shifted(shift))

    def _correction(self, length: float) -> FloatArray:
        """(3, 6) Bezier columns over x in [0, 1]: zero with two derivatives at 0, the mismatch at 1, flat curvature."""
        value, slope = self.mismatch[:, 0], self.mismatch[:, 1] * length
        zero = np.zeros(3)
        return np.stack([zero, zero, zero, value - 0.4 * slope, value - 0.2 * slope, value], axis=1)


def _at_one(at: ConstrainedMotion) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    return at.q[0, 1:], at.dq[0, 1:], at.ddq[0, 1:], float(at.p_fri[0])
