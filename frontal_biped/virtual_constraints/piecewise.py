"""Virtual constraints in pieces: a phase as planned, and beside it what goes on, comes back or dies out.

`anchoring` derives these and says when which of them is taken. Each keeps the planned phase and asks it where it holds.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
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
        return _joined(beta, self.beta_end, self._continuation, self.phase.motion)

    def _continuation(self, beta: FloatArray) -> ConstrainedMotion:
        """`motion` past the end."""
        q, dq, ddq = np.empty((3, len(beta), 4))
        q[:, 0], dq[:, 0], ddq[:, 0] = beta, 1.0, 0.0
        q[:, 1:], dq[:, 1:], ddq[:, 1:], p_fri, dp_fri = self._beyond(beta[:, None])
        return ConstrainedMotion(q, dq, ddq, p_fri[:, 0], dp_fri[:, 0])

    def _beyond(self, beta: Any) -> tuple[Any, Any, Any, Any, Any]:
        """h_d, h_d', h_d'' (..., 3), the FRI target and its slope past the end, at one beta or at a column of them."""
        (q_b, slope, growth, p_fri, dp_fri), l, m = self._at_end, self.taper, self.curvature_taper
        x = beta - self.beta_end
        slow, fast, decay = np.exp(-x / l), np.exp(-x / m), np.exp(-x / self.fri_taper)
        return (
            q_b + slope * l * (1.0 - slow) + growth * m * (m - (m + x) * fast),
            slope * slow + growth * x * fast,
            growth * (1.0 - x / m) * fast - slope / l * slow,
            p_fri + dp_fri * self.fri_taper * (1.0 - decay),
            dp_fri * decay,
        )

    @cached_property
    def _at_end(self) -> tuple[FloatArray, FloatArray, FloatArray, float, float]:
        """Of the planned phase: pose, slope and h'' + h'/l of q_b (3,), the FRI target and its slope."""
        q, dq, ddq, p_fri, dp_fri = self.phase.motion(np.array([self.beta_end]))
        return q[0, 1:], dq[0, 1:], ddq[0, 1:] + dq[0, 1:] / self.taper, p_fri.item(), dp_fri.item()

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta."""
        phase = self.phase
        return phase.desired(beta) if beta <= phase.beta_end else self._beyond(beta)[:4]

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
        return _joined(beta, self.beta_start, self.rising.motion, self.phase.motion)

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
        return _joined(beta, self.join, self._rejoining, self.phase.motion)

    def _rejoining(self, beta: FloatArray) -> ConstrainedMotion:
        """`motion` where the mismatch lasts."""
        planned, more = self.phase.motion(beta), self._correction.motion(beta)
        q, dq, ddq = planned[:3]
        for part, added in zip((q, dq, ddq), more[:3], strict=True):
            part[:, 1:] += added[:, 1:]
        return ConstrainedMotion(q, dq, ddq, planned.p_fri + more.p_fri, planned.dp_fri + more.dp_fri)

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta."""
        return self.phase.desired(beta) if beta <= self.join else _at_one(self.motion(np.array([beta])))

    def shifted(self, shift: float) -> "RejoiningPhase":
        """The phase with its FRI target moved by a constant [m]."""
        return replace(self, phase=self.phase.shifted(shift))

    @cached_property
    def _correction(self) -> Phase:
        """The mismatch from where it has died out, with two derivatives, to where it begins, with flat curvature."""
        value, slope = self.mismatch[:, 0], self.mismatch[:, 1] * (self.begin - self.join)
        zero = np.zeros(3)
        columns = np.stack([zero, zero, zero, value - 0.4 * slope, value - 0.2 * slope, value], axis=1)
        fri = self.fri_mismatch * np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
        return Phase(self.join, self.begin, columns, fri)


Motions = Callable[[FloatArray], ConstrainedMotion]


def _joined(beta: FloatArray, at: float, above: Motions, below: Motions) -> ConstrainedMotion:
    """One motion above a beta and another at and below it, each asked only where it holds."""
    beta = np.atleast_1d(np.asarray(beta, dtype=float))
    high = beta > at
    if not high.any():
        return below(beta)
    if high.all():
        return above(beta)
    parts = []
    for up, down in zip(above(beta[high]), below(beta[~high]), strict=True):
        part = np.empty((len(beta), *up.shape[1:]))
        part[high], part[~high] = up, down
        parts.append(part)
    return ConstrainedMotion(*parts)


def _at_one(at: ConstrainedMotion) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    return at.q[0, 1:], at.dq[0, 1:], at.ddq[0, 1:], float(at.p_fri[0])
