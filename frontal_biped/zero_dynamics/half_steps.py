"""The two halves of a step: rising from a landing to its reversal, falling from a reversal to its landing."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import ceil, inf, isfinite, sqrt
from typing import Generic

from scipy.optimize import brentq

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.impact import Landing, impact
from frontal_biped.virtual_constraints.contract import RisingConstraints, RisingT, VirtualConstraints
from frontal_biped.zero_dynamics.energy import PhaseEnergy, phase_energy

SURPLUS_ACCURACY = 1e-4
"""Energy error that is left to the transitions [kg^2 m^4/s^2]; a gait has some hundreds."""

STRETCH, STRETCHES = 0.15, 40
"""Steps by which the end of a phase is moved outwards, relative to its range, and how many."""

UNDOUBTED = 0.01
"""Share of the first value that the lowest of a row keeps, where the parabola is believed that none is lower."""

BLOCKED = 1e4
"""Surplus where the phase does not reach its end [kg^2 m^4/s^2]."""


@dataclass(frozen=True)
class ConstrainedState:
    """A state on the virtual constraints, where a rising phase begins: dq = (1, slope) dbeta, whatever dbeta is.

    Attributes:
        q: (4,) configuration [rad].
        slope: (3,) dq_b/dbeta [-].
        dbeta: rate of the stance ankle [rad/s].
    """

    q: FloatArray
    slope: FloatArray
    dbeta: float


def falling_energy(biped: FrontalBiped, phase: VirtualConstraints, reversal: float) -> PhaseEnergy:
    """Energy of a falling phase from a reversal to its end."""
    above = [b - 0.075 * phase.range for b in phase.breaks]
    middle = 0.5 * (min(reversal, phase.beta_start) + phase.beta_end)
    return phase_energy(biped, phase, reversal, phase.beta_end, (*phase.breaks, *above, middle))


def rising_energy(biped: FrontalBiped, phase: RisingConstraints, dbeta: float = inf) -> PhaseEnergy:
    """Energy of a rising phase from its start up to the barrier, or as far as it is followed.

    Args:
        biped: the robot.
        phase: rising phase.
        dbeta: speed at its start [rad/s]; not far beyond the reversal of this is looked.
    """
    middle = 0.5 * (phase.beta_start + phase.beta_end)
    *panels, end = phase.past_end
    return phase_energy(biped, phase, phase.beta_start, end, (middle, *panels), to_barrier=True, dbeta=dbeta)


def land_on_constraints(biped: FrontalBiped, falling: PhaseEnergy) -> ConstrainedState:
    """The state after the landing of a falling phase that began at rest.

    Raises:
        ReversalError: the robot stops before the impact.
    """
    landing, dbeta = landing_at_end(biped, falling), speed_at_end(falling)
    return ConstrainedState(landing.q_plus.copy(), landing.slope, float(landing.speed_ratio * dbeta))


def landing_at_end(biped: FrontalBiped, falling: PhaseEnergy) -> Landing:
    """The impact at the end of a falling phase, per unit of dbeta."""
    return impact(biped, falling.motion.q[-1], falling.motion.dq[-1])


def speed_at_end(falling: PhaseEnergy) -> float:
    """Rate dbeta at the end of a falling phase that began at rest [rad/s], negative.

    Raises:
        ReversalError: the robot stops before.
    """
    if not falling.complete:
        raise ReversalError(falling.why)
    if not falling.integrals.spent_at.ravel()[1:].max() < 0.0:  # of a robot that leans the wrong way from the start
        raise ReversalError("the robot stops in the falling phase")
    zeta = -falling.gained.item(-1) * falling.spent
    return -sqrt(2.0 * zeta) / falling.restricted.I_P.item(-1)


def stretch_to_reversal(biped: FrontalBiped, phase: RisingT, dbeta: float) -> RisingT:
    """The phase stretched so that a landing too fast for it reverses exactly at its end.

    The same poses in the same order, the last one reached where the energy is spent: the self-consistent reversal of
    `reversal.problem`, solved for a given speed. The phase itself where it is not too fast, or nothing stops the robot.

    Args:
        biped: the robot.
        phase: rising phase.
        dbeta: after the landing [rad/s].
    """
    return Stretching(biped, phase).to_reversal(dbeta)


@dataclass(frozen=True)
class Stretching(Generic[RisingT]):
    """`stretch_to_reversal` of one phase at any speed: what a stretched phase takes is found once, and serves them all.

    Attributes:
        biped: the robot.
        phase: rising phase.
    """

    biped: FrontalBiped
    phase: RisingT

    @cached_property
    def _taken(self) -> dict[float, tuple[float, float] | None]:
        """By the end of the stretched phase, I_P at its start and what it takes; None where it does not get there."""
        return {}

    def _surplus(self, dbeta: float, end: float) -> float:
        if end not in self._taken:
            self._taken[end] = _taken(self.biped, self.phase.stretched(end))
        return _left(self._taken[end], dbeta)

    def to_reversal(self, dbeta: float) -> RisingT:
        """The phase, stretched for a landing at dbeta [rad/s]."""
        phase, surplus = self.phase, partial(self._surplus, dbeta)
        if surplus(phase.beta_end) <= SURPLUS_ACCURACY:
            return phase
        ends = [phase.beta_end + k * STRETCH * phase.range for k in range(STRETCHES + 1)]
        k = first_not_positive([partial(surplus, end) for end in ends])
        return phase if k is None else phase.stretched(float(brentq(surplus, ends[k - 1], ends[k], xtol=1e-12)))


def first_not_positive(values: Sequence[Callable[[], float]]) -> int | None:
    """Place of the first value that is not positive, in a row that begins with a positive one; None: there is none.

    Stretched, a phase takes an energy that is all but quadratic in its end. The parabola through the first three values
    says where to look; where it does not hold they are looked at one by one.
    """
    start, *near = (value() for value in values[:3])
    bend = start - 2.0 * near[0] + near[1]
    slope = near[0] - start - 0.5 * bend
    under = slope * slope - 2.0 * bend * start
    if min(near) > 0.0 and bend > 0.0 > slope:
        lowest = min(round(-slope / bend), len(values) - 1)
        if under < 0.0 and values[lowest]() > UNDOUBTED * start:
            return None
        place = ceil(2.0 * start / (sqrt(max(under, 0.0)) - slope))
        if under >= 0.0 and place < len(values) and values[place]() <= 0.0 < values[place - 1]():
            return place
    return next((place for place, value in enumerate(values) if value() <= 0.0), None)


def energy_surplus(biped: FrontalBiped, phase: VirtualConstraints, dbeta: float) -> float:
    """Energy after a landing beyond what rising to the planned end of the phase takes [kg^2 m^4/s^2].

    `BLOCKED` where the phase does not reach its end: as if far too fast.
    """
    return _left(_taken(biped, phase), dbeta)


def _taken(biped: FrontalBiped, phase: VirtualConstraints) -> tuple[float, float] | None:
    """I_P at the start of a phase [kg m^2] and R at its end [kg^2 m^4/s^2]; None where it does not get there."""
    try:
        energy = phase_energy(biped, phase, phase.beta_start, phase.beta_end, whole=True)
    except ReversalError:
        return None
    return energy.start_inertia, energy.spent


def _left(taken: tuple[float, float] | None, dbeta: float, missing: float = 0.0) -> float:
    if taken is None:
        return BLOCKED
    inertia, spent = taken
    surplus = 0.5 * (inertia * dbeta) ** 2 - spent + missing
    return surplus if isfinite(surplus) else BLOCKED


def surplus_at_end(energy: PhaseEnergy, dbeta: float) -> float:
    """`energy_surplus` of a phase that has been integrated; `BLOCKED` is added where it does not reach its end."""
    return _left((energy.start_inertia, energy.spent), dbeta, 0.0 if energy.complete else BLOCKED)
