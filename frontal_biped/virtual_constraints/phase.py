"""One phase of a step, rising or falling: joints and FRI target as Bezier functions of beta."""

from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.virtual_constraints.bezier import bernstein, bernstein_at, bernstein_derivative, derivative_columns


class StepPhase(Enum):
    """The continuous phases of a step ([O] HG1): dbeta > 0 while rising, dbeta < 0 while falling.

    Attributes:
        sign: of dbeta, +1 rising and -1 falling: how runs store the phase.
    """

    RISING = "rising"
    FALLING = "falling"

    sign: float

    def __init__(self, name: str) -> None:
        self.sign = 1.0 if name == "rising" else -1.0

    __hash__ = object.__hash__  # as `Stance`

    @classmethod
    def of_sign(cls, sign: float) -> "StepPhase":
        """The phase that `sign` stands for."""
        return cls.RISING if sign > 0.0 else cls.FALLING


RISING, FALLING = StepPhase.RISING, StepPhase.FALLING
"""Kept: a member of an enumeration is a search, and every tick asks for them."""


class ConstrainedMotion(NamedTuple):
    """The robot on the virtual constraints at the points beta (n,): q = (beta, h_d(beta)).

    Attributes:
        q: (n, 4) [rad].
        dq: (n, 4) dq/dbeta [-].
        ddq: (n, 4) d2q/dbeta2 [1/rad].
        p_fri: (n,) FRI target h_d^FRI [m].
        dp_fri: (n,) its derivative with respect to beta [m/rad].
    """

    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    p_fri: FloatArray
    dp_fri: FloatArray


class PhaseBasis(NamedTuple):
    """Bernstein matrices at fixed phase values s (n,): joints value, first and second derivative; FRI value, first.

    They depend on s alone, so a quadrature with fixed nodes computes them once.
    """

    joints: tuple[FloatArray, FloatArray, FloatArray]
    fri: tuple[FloatArray, FloatArray]


def phase_basis(degree: int, fri_degree: int, s: FloatArray) -> PhaseBasis:
    """Bernstein matrices of the given degrees at s (n,)."""
    return PhaseBasis(
        (bernstein(degree, s), bernstein_derivative(degree, s, 1), bernstein_derivative(degree, s, 2)),
        (bernstein(fri_degree, s), bernstein_derivative(fri_degree, s, 1)),
    )


@dataclass(frozen=True)
class Phase:
    """Virtual constraints of one phase: a single polynomial.

    s = (beta - beta_start) / (beta_end - beta_start) grows with time in both phases. Past s = 1 (a reversal later
    than planned) and before s = 0 the polynomials simply go on.

    Attributes:
        beta_start: beta at the start of the phase [rad].
        beta_end: beta at its end [rad]; larger than the start when rising, smaller when falling.
        joint_bezier: (3, M + 1) coefficients of stance hip, swing hip, swing ankle [rad].
        fri_bezier: (M_FRI + 1,) coefficients of the FRI target [m].
    """

    beta_start: float
    beta_end: float
    joint_bezier: FloatArray
    fri_bezier: FloatArray

    @property
    def degree(self) -> int:
        """Degree M of the joint polynomials."""
        return self.joint_bezier.shape[1] - 1

    @property
    def fri_degree(self) -> int:
        """Degree of the FRI polynomial."""
        return self.fri_bezier.shape[0] - 1

    @property
    def range(self) -> float:
        """beta_end - beta_start [rad], negative when falling."""
        return self.beta_end - self.beta_start

    @property
    def breaks(self) -> tuple[float, ...]:
        """One polynomial changes its form nowhere."""
        return ()

    @property
    def past_end(self) -> tuple[float, ...]:
        """Past s = 1 the bare polynomial goes on; short panels, for it bends [rad]."""
        return tuple(self.beta_end + k * 0.25 * self.range for k in range(5))

    def s(self, beta: FloatArray | float) -> FloatArray:
        """Phase value of beta."""
        return np.asarray((beta - self.beta_start) / self.range)

    def motion(self, beta: FloatArray) -> ConstrainedMotion:
        """The robot on the virtual constraints at beta (n,) [rad]."""
        beta = np.atleast_1d(np.asarray(beta, dtype=float))
        table = self._table
        values = bernstein(table.shape[1] - 1, self.s(beta)) @ table.T
        q, dq, ddq = parts = np.empty((3, len(beta), 4))
        q[:, 0], dq[:, 0], ddq[:, 0] = beta, 1.0, 0.0
        parts[:, :, 1:] = values[:, :9].reshape(-1, 3, 3).swapaxes(0, 1)
        return ConstrainedMotion(q, dq, ddq, values[:, 9], values[:, 10])

    def desired(self, beta: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """h_d (3,), dh_d/dbeta (3,), d2h_d/dbeta2 (3,) and the FRI target at one beta: what a control tick needs."""
        table, n, start, length = self._at_one
        values = table.dot(bernstein_at(n, (float(beta) - start) / length))
        return values[:3], values[3:6], values[6:9], values.item(9)

    def shifted(self, shift: float) -> "Phase":
        """The phase with its FRI target moved by a constant [m]."""
        return replace(self, fri_bezier=self.fri_bezier + shift)

    def unshifted(self) -> "Phase":
        """Itself: shifted, it is a phase like any other, with nothing to take back."""
        return self

    def stretched(self, end: float) -> "Phase":
        """The phase that reaches its final pose at another beta [rad]; pose and slope at its start stay."""
        assert self.degree >= 3  # or column 1 would be the last but one
        columns = self.joint_bezier.copy()
        columns[:, 1] = columns[:, 0] + (columns[:, 1] - columns[:, 0]) * (end - self.beta_start) / self.range
        return replace(self, beta_end=end, joint_bezier=columns)

    @cached_property
    def _table(self) -> FloatArray:
        """(11, n + 1) h_d, h_d', h_d'', the FRI target and its slope in one Bernstein basis, for one product."""
        M, M_fri = self.degree, self.fri_degree
        n = max(M, M_fri)
        joints, fri = self.joint_bezier, self.fri_bezier
        of_joints = [joints @ derivative_columns(M, k, n) / self.range**k for k in range(3)]
        of_fri = [fri @ derivative_columns(M_fri, k, n) / self.range**k for k in range(2)]
        return np.concatenate([*of_joints, of_fri])

    @cached_property
    def _at_one(self) -> tuple[FloatArray, int, float, float]:
        """What `desired` needs: the table, its degree, and where the phase starts and how far it goes [rad]."""
        return self._table, self._table.shape[1] - 1, self.beta_start, self.range
