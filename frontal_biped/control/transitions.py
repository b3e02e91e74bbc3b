"""What the phases of the next half-step are: the one interface of every stabiliser, and the two plain answers.

A stabiliser is asked twice a step, after the impact and at the reversal, and answers with the virtual constraints of
the phase that begins. The walking controller and the restricted return map ask the same object, so the closed form
describes what is walked.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.phase_energy import Landed, rising_energy
from frontal_biped.virtual_constraints.anchoring import ContinuedPhase, anchored_falling, anchored_rising, continued
from frontal_biped.virtual_constraints.phase import Phase

SLOWEST = 0.02
"""Share of the planned post-impact speed below which dq_b/dbeta is taken from the plan: it divides by the speed."""

LEAST_RANGE = 0.1
"""A rising phase that begins nearer to its end than this share of the planned range keeps the planned start."""

TAPERS = (1.0, 0.7, 0.5, 0.35, 0.25, 0.18, 0.12, 0.08, 0.05)
"""Lengths of the continuation tried, relative to the range of the rising phase."""

AS_PLANNED = 1e-9
"""[rad] a landing this near to the planned one is the planned one."""


class Stabiliser(Protocol):
    """Chooses the virtual constraints of each phase."""

    @property
    def name(self) -> str:
        """For reports."""

    def rising(self, landed: Landed) -> Phase:
        """Virtual constraints from an impact on."""

    def falling(self, rising: Phase, reversal: float) -> Phase:
        """Virtual constraints from a reversal on, given the phase that reversed and where [rad]."""


@dataclass(frozen=True)
class FixedTransitions:
    """The paper's: both phases as planned, whatever happens.

    Attributes:
        gait: the gait.
    """

    gait: Gait

    name = "fixed"

    def rising(self, landed: Landed) -> Phase:
        """The planned rising phase."""
        return self.gait.rising

    def falling(self, rising: Phase, reversal: float) -> Phase:
        """The planned falling phase."""
        return self.gait.falling


@dataclass(frozen=True)
class AdaptiveTransitions:
    """Reversal-adaptive hybrid invariance: each phase begins where the robot is (see `anchoring`).

    Attributes:
        biped: the robot.
        gait: the gait.
    """

    biped: FrontalBiped
    gait: Gait

    name = "adaptive"

    @cached_property
    def planned_rising(self) -> ContinuedPhase:
        """The gait's rising phase with the longest, that is gentlest, continuation that keeps I_P > 0 to the barrier.

        Where none does, the one that takes the most energy.
        """
        best, most = continued(self.gait.rising), -np.inf
        for share in TAPERS:
            phase = continued(self.gait.rising, share * self.gait.rising.range)
            try:
                energy = rising_energy(self.biped, phase)
            except ReversalError:
                continue
            if energy.highest > most:
                best, most = phase, energy.highest
            if energy.reaches_barrier:
                return phase
        return best

    @cached_property
    def _planned_start(self) -> tuple[FloatArray, FloatArray]:
        at = self.gait.rising.motion(np.array([self.gait.rising.beta_start]))
        return at.q[0], at.dq[0, 1:]

    def rising(self, landed: Landed) -> ContinuedPhase:
        """The rising phase anchored to the state after the impact."""
        planned = self.planned_rising
        q, slope = self._planned_start
        if abs(landed.dbeta) > SLOWEST * self.gait.orbit.beta_dot_after_impact:
            slope = landed.slope
        pose_error = float(np.max(np.abs(landed.q - q)))
        slope_error = float(np.max(np.abs(slope - self._planned_start[1]))) * abs(planned.range)
        if max(pose_error, slope_error) < AS_PLANNED:
            return planned
        if planned.beta_end - landed.q[0] < LEAST_RANGE * planned.range:
            return planned
        return anchored_rising(planned, float(landed.q[0]), landed.q[1:], slope)

    def falling(self, rising: Phase, reversal: float) -> Phase:
        """The falling phase from the actual reversal."""
        return anchored_falling(self.gait.falling, rising, reversal)
