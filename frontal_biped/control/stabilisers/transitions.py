"""What the phases of the next half-step are: the one interface of every stabiliser, and the two plain answers.

A stabiliser is asked twice a step, after the impact and at the reversal, and answers with the virtual constraints of
the phase that begins. The walking controller and the restricted return map ask the same object, so the closed form
describes what is walked.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Generic, Protocol, TypeVar

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.margins import ContactMargins
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.anchoring import (
    anchored_falling,
    anchored_rising,
    continued,
    rescaled_falling,
    with_ends,
)
from frontal_biped.virtual_constraints.contract import RisingConstraints, VirtualConstraints
from frontal_biped.virtual_constraints.phase import ConstrainedMotion, Phase
from frontal_biped.virtual_constraints.piecewise import ContinuedPhase
from frontal_biped.zero_dynamics.energy import PhaseEnergy
from frontal_biped.zero_dynamics.half_steps import ConstrainedState, Stretching, rising_energy
from frontal_biped.zero_dynamics.restricted import RestrictedDynamics, project_dynamics

T = TypeVar("T")

SLOWEST = 0.02
"""Share of the planned post-impact speed below which dq_b/dbeta is taken from the plan: it divides by the speed."""

LEAST_RANGE = 0.1
"""A rising phase that begins nearer to its end than this share of the planned range keeps the planned start."""

TAPERS = (3.0, 1.0, 0.35, 0.08)
CURVATURE_TAPERS = (0.35, 0.08, 0.03)
"""Lengths of the continuation tried, relative to the range of the rising phase."""

REJOINS = (2.0, 4.0, 8.0, 20.0, np.inf)
"""Lengths c over which an early falling phase rejoins its path: the shortest that keeps I_P is taken."""

ENOUGH_INERTIA = 0.9
"""Share of the planned falling phase's smallest I_P that counts as kept."""

LOOKS = 25
"""Points of a falling phase, evenly spaced in beta, at which I_P is looked at."""

FULL_LOAD = 0.9
"""Share of the torque and friction limits up to which a late reversal is left to the continuation."""

AS_PLANNED = 1e-9
"""[rad] a landing this near to the planned one is the planned one."""


class Stabiliser(Protocol):
    """Chooses the virtual constraints of each phase."""

    @property
    def name(self) -> str:
        """For reports."""

    def rising(self, landed: ConstrainedState) -> RisingConstraints:
        """Virtual constraints from an impact on."""

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """Virtual constraints from a reversal on, given the phase that reversed and where [rad]."""


@dataclass(frozen=True)
class FixedTransitions:
    """The paper's: both phases as planned, whatever happens.

    Attributes:
        gait: the gait.
    """

    gait: PlannedStep

    name = "fixed"

    def rising(self, landed: ConstrainedState) -> Phase:
        """The planned rising phase."""
        return self.gait.rising

    def falling(self, rising: RisingConstraints, reversal: float) -> Phase:
        """The planned falling phase."""
        return self.gait.falling


@dataclass(frozen=True)
class ReanchoringTransitions:
    """Re-anchoring as it comes: each phase begins where the robot is, whatever that asks of it (see `anchoring`).

    The stabiliser "re-anchored" is this without anticipation. What `simulate` calls "adaptive" chooses among the ways
    to re-anchor by what the contact can carry: `LookAheadTransitions`.

    Attributes:
        biped: the robot.
        gait: the gait.
        anticipate: stretch the rising phase of a landing so fast that its continuation would overload the robot?
        rejoin: does an early falling phase rejoin its path, which keeps the return map, or is it rescaled as a whole,
            which asks less where reversals are always a little off?
    """

    biped: FrontalBiped
    gait: PlannedStep
    anticipate: bool = True
    rejoin: bool = True

    @property
    def name(self) -> str:
        """For reports."""
        stretched, rescaled = ", stretched where fast" * self.anticipate, ", rescaled where early" * (not self.rejoin)
        return f"re-anchored{stretched}{rescaled}"

    @cached_property
    def planned_rising(self) -> ContinuedPhase:
        """The gait's rising phase with the continuation that asks the least torque half-way up the energy barrier.

        Of those that keep I_P > 0 up to the barrier; where none does, the one that takes the most energy.
        """
        return _continuation(_Itself(self.biped), _Itself(self.gait))

    @cached_property
    def _limits(self) -> ContactMargins:
        return ContactMargins(self.biped, self.gait)

    @cached_property
    def _planned_energy(self) -> PhaseEnergy:
        return rising_energy(self.biped, self.planned_rising)

    @cached_property
    def _planned_stretching(self) -> Stretching[ContinuedPhase]:
        return Stretching(self.biped, self.planned_rising)

    @cached_property
    def _planned_start(self) -> tuple[FloatArray, FloatArray]:
        at = self.gait.rising.motion(np.array([self.gait.rising.beta_start]))
        return at.q[0], at.dq[0, 1:]

    def rising(self, landed: ConstrainedState) -> ContinuedPhase:
        """The rising phase anchored to the state after the impact."""
        planned = self.planned_rising
        q, slope = self._planned_start
        if abs(landed.dbeta) > SLOWEST * self.gait.speed_after_impact:
            slope = landed.slope
        pose_error = float(np.max(np.abs(landed.q - q)))
        slope_error = float(np.max(np.abs(slope - self._planned_start[1]))) * abs(planned.range)
        near_end = planned.beta_end - landed.q[0] < LEAST_RANGE * planned.range
        as_planned = max(pose_error, slope_error) < AS_PLANNED or near_end
        phase = planned if as_planned else anchored_rising(planned, float(landed.q[0]), landed.q[1:], slope)
        if not self.anticipate or landed.dbeta <= 0.0:
            return phase
        energy = self._planned_energy if as_planned else rising_energy(self.biped, phase, landed.dbeta)
        zeta = 0.5 * (energy.start_inertia * landed.dbeta) ** 2
        if energy.end < phase.beta_end:
            return phase
        if zeta <= energy.at(phase.beta_end)[1]:
            return phase
        if zeta < energy.highest and self._limits.load(energy, zeta) < FULL_LOAD:
            return phase
        stretching = self._planned_stretching if as_planned else Stretching(self.biped, phase)
        return stretching.to_reversal(landed.dbeta)

    def falling(self, rising: RisingConstraints, reversal: float) -> VirtualConstraints:
        """The falling phase from the actual reversal."""
        return self.falling_to(rising, reversal, self.gait.falling.beta_end, self.gait.falling.joint_bezier[:, -1])

    def falling_to(
        self, rising: RisingConstraints, reversal: float, beta: float, pose: FloatArray
    ) -> VirtualConstraints:
        """The falling phase from the actual reversal to a final pose.

        Args:
            rising: the phase that reversed.
            reversal: where [rad].
            beta: stance ankle angle at the impact [rad].
            pose: (3,) q_b there [rad].
        """
        planned = self._planned_falling(rising, beta, pose)
        if reversal >= planned.beta_start:
            return anchored_falling(planned, rising, reversal)
        if not self.rejoin:
            return rescaled_falling(planned, rising, reversal)
        return anchored_falling(planned, rising, reversal, self._rejoin_of(planned, rising, reversal))

    def rejoin_of(self, rising: RisingConstraints, reversal: float) -> float:
        """c of `REJOINS` with which `falling` rejoins its path from an early reversal [rad]."""
        return self._rejoin_of(self._as_planned(rising), rising, reversal)

    def rejoining(self, rising: RisingConstraints, reversal: float, c: float) -> VirtualConstraints:
        """What `falling` answers to a reversal [rad] if the length c is known already."""
        return anchored_falling(self._as_planned(rising), rising, reversal, c)

    def _as_planned(self, rising: RisingConstraints) -> Phase:
        return self._planned_falling(rising, self.gait.falling.beta_end, self.gait.falling.joint_bezier[:, -1])

    def _planned_falling(self, rising: RisingConstraints, beta: float, pose: FloatArray) -> Phase:
        """The falling phase that begins where the rising one ends, to a final pose (3,) [rad] at beta [rad]."""
        planned = self.gait.falling
        at = rising.motion(np.array([rising.beta_end]))
        start = self._planned_reversal
        moved = max(
            abs(rising.beta_end - planned.beta_start),
            np.abs(at.q - start.q).max().item(),
            np.abs(at.dq - start.dq).max().item() * abs(planned.range),
            abs(beta - planned.beta_end),
            np.abs(pose - planned.joint_bezier[:, -1]).max().item(),
        )
        if moved > AS_PLANNED:
            slope, p_fri = at.dq[0, 1:], float(at.p_fri[0])
            planned = with_ends(planned, rising.beta_end, at.q[0, 1:], slope, beta, pose, p_fri)
        return planned

    def _rejoin_of(self, planned: Phase, rising: RisingConstraints, reversal: float) -> float:
        as_planned = planned is self.gait.falling
        own = self._planned_inertia if as_planned else self._least_inertia([planned], planned.beta_start).item()
        phases = [anchored_falling(planned, rising, reversal, rejoin) for rejoin in REJOINS]
        least = self._least_inertia(phases, reversal)
        enough = least >= ENOUGH_INERTIA * own
        return REJOINS[int((enough if enough.any() else least).argmax())]

    @cached_property
    def _planned_reversal(self) -> ConstrainedMotion:
        return self.gait.falling.motion(np.array([self.gait.falling.beta_start]))

    @cached_property
    def _planned_inertia(self) -> float:
        return self._least_inertia([self.gait.falling], self.gait.falling.beta_start).item()

    def _least_inertia(self, phases: Sequence[VirtualConstraints], start: float) -> FloatArray:
        """Smallest I_P of each of several falling phases between the same ends [kg m^2]."""
        beta = start + (phases[0].beta_end - start) * np.linspace(0.0, 1.0, LOOKS)
        motions = zip(*(phase.motion(beta) for phase in phases), strict=True)
        motion = ConstrainedMotion(*map(np.concatenate, motions))
        restricted = RestrictedDynamics(project_dynamics(self.biped, motion), motion.p_fri, motion.dp_fri)
        return restricted.I_P.reshape(len(phases), LOOKS).min(axis=1)


@dataclass(frozen=True, eq=False)
class _Itself(Generic[T]):
    """A thing that is compared by what it is, not by what it holds."""

    thing: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Itself) and other.thing is self.thing

    def __hash__(self) -> int:
        return id(self.thing)


@lru_cache(maxsize=8)  # walks of one gait come one after another, and each has a stabiliser of its own
def _continuation(robot: _Itself[FrontalBiped], step: _Itself[PlannedStep]) -> ContinuedPhase:
    """See `ReanchoringTransitions.planned_rising`."""
    biped, planned = robot.thing, step.thing.rising
    limits = ContactMargins(biped, step.thing)
    at = planned.motion(np.array([planned.beta_end]))
    # the FRI target stops half-way to the end of the sole it moves towards
    slope, outer, inner = float(at.dp_fri[0]), *biped.sole
    room = 0.5 * max((inner if slope > 0.0 else -outer) - np.sign(slope) * float(at.p_fri[0]), 1e-3)
    best, rank = continued(planned, TAPERS[-1] * planned.range), (False, -np.inf)
    for share in TAPERS:
        for curvature in CURVATURE_TAPERS:
            if curvature > share:
                continue
            taper = share * planned.range
            fri = min(taper, room / max(abs(slope), 1e-9))
            phase = continued(planned, taper, curvature * planned.range, fri)
            try:
                energy = rising_energy(biped, phase)
            except ReversalError:
                continue
            value = energy.highest
            if energy.reaches_barrier:
                required = energy.at(planned.beta_end)[1]
                value = -limits.load(energy, 0.5 * (required + energy.highest))
            if (energy.reaches_barrier, value) > rank:
                best, rank = phase, (energy.reaches_barrier, value)
    return best
