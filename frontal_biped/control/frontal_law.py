r"""The frontal plane of a walk, over the sway: the paper's outputs and FRI target, the energy of the orbit kept.

Of the planar `Walker` and of the one in space. Each phase begins where the robot is (`swayed`); the FRI moves inside
the sole at every tick so that the energy sideways is that of the orbit (`SwayOrbit`),

.. math:: \Delta \ddot s = \pm \frac{\tfrac12 \dot s^2 - E(s)}{\ell} - a_s, \qquad
          \Delta p_{FRI} = -\frac{z}{g} \Delta \ddot s

(plus while rising, a_s the mean acceleration that the model does not explain), and from step to step an offset of the
FRI while falling takes off what is left of the energy error half-way down: what the model leaves out (in space legs
that swing forwards, and an impact with every joint free) comes back at every step.

A gait that travels sideways has two steps in turn: phases and orbit are those of the step that is walked on the foot
that stands. Its wide step A belongs to the foot that stands where the law is reset: on the left foot the robot travels
to its right.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import SHIFT_ROOM
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.landing_widths import LandingWidths
from frontal_biped.control.torques.linearisation import Targets
from frontal_biped.control.torques.tracking import ErrorDynamics
from frontal_biped.control.walker.energy_law import EnergySettings
from frontal_biped.gait.planned_step import PlannedStep
from frontal_biped.gait.sideways import AnyGait, orbits_in_turn, steps_in_turn
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.numerics.between import between
from frontal_biped.virtual_constraints.phase import FALLING, RISING, StepPhase
from frontal_biped.virtual_constraints.swayed import BegunPhase, OtherEnd, SwayedPhase
from frontal_biped.zero_dynamics.poincare import StepOrbit
from frontal_biped.zero_dynamics.sway_orbit import SwayOrbit

LEARNED = 0.2
"""Share of the sole, from the ankle to either end, that the learned offset may take [-]."""

DISTURBED = 0.12
"""Relative speed error half-way down from which on a step was disturbed, and is not learned from [-]."""

TURNED = 0.004
"""Hysteresis of the sway's rate at a reversal [m/s]."""

SLOWEST = 0.02
"""Rate of the sway below which the slope after a landing is taken from the plan: it divides by the rate [m/s]."""


@dataclass(frozen=True)
class FrontalSettings:
    """How the frontal plane is kept.

    Attributes:
        energy: how the energy of the orbit is kept at every tick, lengths as shares of the sway's range; None: not at
            all.
        learning: share of the energy error half-way down that the offset of the next step on that foot takes off.
        settle: time after a landing when the virtual constraints begin anew, from what is measured [s]; 0: never.
    """

    energy: EnergySettings | None = field(default_factory=lambda: EnergySettings(blank=0.025))
    learning: float = 0.5
    settle: float = 0.03


class FrontalTargets(NamedTuple):
    """What the frontal plane asks for.

    Attributes:
        targets: of the paper's outputs and the FRI.
        y: (3,) output error [rad].
        dy: (3,) its rate [rad/s].
        line: (2, 4) accelerations of four joints that give the outputs theirs, the ankle's yet to follow (`over_sway`).
    """

    targets: Targets
    y: FloatArray
    dy: FloatArray
    line: FloatArray


@dataclass(frozen=True)
class _SwayedStep:
    """One of the steps that are walked in turn, over the sway.

    Attributes:
        phases: its virtual constraints.
        orbit: energy and time.
        half_way: sway in the middle of the fall [m].
        energy_per_offset: that an offset of the FRI over the upper half of the fall takes off [m/s^2].
    """

    phases: dict[StepPhase, SwayedPhase]
    orbit: SwayOrbit
    half_way: float
    energy_per_offset: float

    @classmethod
    def of(cls, biped: FrontalBiped, step: PlannedStep, planned: StepOrbit, decay: float) -> "_SwayedStep":
        phases = {
            RISING: SwayedPhase(biped, step.rising),
            FALLING: SwayedPhase(biped, step.falling),
        }
        orbit = SwayOrbit(biped, planned.rising, planned.falling, decay)
        energy_per_offset = 0.5 * orbit.ranges[FALLING] * orbit.omega**2
        return cls(phases, orbit, orbit.half_way(FALLING), energy_per_offset)


class FrontalLaw:
    """Targets of the frontal plane along a walk.

    Args:
        biped: the robot as it is believed to be.
        gait: what to walk.
        period: time between ticks [s].
        frequency: of the outputs' error dynamics [rad/s].
        settings: how the plane is kept.
        damping: ratio of the outputs' error dynamics [-].

    Attributes:
        offset: of the FRI target while falling, for either stance foot [m].
        mid_fall: relative speed error half-way down of the last step, NaN before the first [-].
        widening: how much wider than the gait's the present step is to land [m].

    Raises:
        SimulationError: the centre of mass turns back along a phase of the gait.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: AnyGait,
        period: float,
        frequency: float,
        settings: FrontalSettings,
        damping: float = 1.0,
    ) -> None:
        self.settings, self._period = settings, period
        self._errors = ErrorDynamics(frequency, damping)
        decay = np.inf if settings.energy is None else settings.energy.length
        steps = zip(steps_in_turn(gait), orbits_in_turn(biped, gait), strict=True)
        self._steps = [_SwayedStep.of(biped, step, orbit, decay) for step, orbit in steps]
        self._sole = biped.sole
        self._biped, self._planned = biped, steps_in_turn(gait)[0]
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start right after an impact, with the first step of the gait."""
        self._of_foot = {stance: self._steps[0], stance.other: self._steps[-1]}
        self.offset = dict.fromkeys(Stance, 0.0)
        self.mid_fall = float("nan")
        self._bias = dict.fromkeys(Stance, 0.0)
        self._begun: BegunPhase | None = None
        self._stance, self._since = stance, 0.0
        self._until_settled = np.inf
        self._fallen = True  # the first step is not learned from: it began where it was put
        self.widening = 0.0

    @cached_property
    def widths(self) -> LandingWidths:
        """Landings wider or narrower than the gait's."""
        return LandingWidths(self._biped, self._planned)

    @property
    def orbit(self) -> SwayOrbit:
        """Energy and time over the sway, of the step that is walked on the foot that stands."""
        return self._of_foot[self._stance].orbit

    def land(
        self, stance: Stance, sway: Sway, state: State, widening: float = 0.0, out_of_double_support: bool = False
    ) -> None:
        """A foot has landed: the rising phase begins.

        Args:
            stance: the foot.
            sway: after the impact, over that foot.
            state: stance coordinates after the impact.
            widening: how much wider than the gait's this step is to land [m].
            out_of_double_support: has the other foot been lifted, instead?
        """
        # of steps that begin or end at another width the energy half-way down is not the orbit's
        self._fallen = bool(widening or self.widening or out_of_double_support)
        self._stance, self._since, self.widening = stance, 0.0, widening
        self._until_settled = self.settings.settle or np.inf
        self._begin(RISING, sway, state)

    def at(
        self,
        phase: StepPhase,
        state: State,
        sway: Sway,
        event: PhaseEvent | None,
        unexplained: float,
    ) -> FrontalTargets:
        """Targets at a state.

        Args:
            phase: rising or falling.
            state: stance coordinates.
            sway: of the centre of mass.
            event: a reversal or a turn outwards that was noticed here; a landing is told to `land`.
            unexplained: acceleration of the sway that the model does not explain [m/s^2].
        """
        self._until_settled -= self._period
        self._since += self._period
        if self._begun is None or (self._until_settled <= 0.0 and phase is RISING):
            self._until_settled = np.inf
            self._begin(phase, sway, state)
        elif event is not None and event is not PhaseEvent.LANDING:
            # where the robot turns every rate is zero, and the phase before says with which slope it goes on
            self._until_settled = np.inf
            before = self._begun.at(sway.value)
            phase_of = self._of_foot[self._stance].phases[phase]
            self._begun = phase_of.begun(sway.value, before.h_d, before.h_d1, self._end(phase))
        assert self._begun is not None
        shift = self._shift(phase, sway, unexplained)
        if phase is FALLING:
            self._learn(sway)
            shift += self.offset[self._stance]
        asked = self._begun.at(sway.value)
        line, y, dy, ddy, curve = self._errors.at(*state, sway.rate, asked.h_d, asked.h_d1, asked.h_d2)
        outer, inner = self._sole
        p_fri = between(SHIFT_ROOM * outer, asked.p_fri + shift, SHIFT_ROOM * inner)
        return FrontalTargets(Targets(asked.h_d1, curve, ddy, p_fri, sway=sway), y, dy, line)

    def _begin(self, phase: StepPhase, sway: Sway, state: State) -> None:
        pose, rates = state.q[1:], state.dq[1:]
        slope = rates / sway.rate if abs(sway.rate) > SLOWEST else None
        self._begun = self._of_foot[self._stance].phases[phase].begun(sway.value, pose, slope, self._end(phase))

    def _end(self, phase: StepPhase) -> OtherEnd | None:
        """Where a phase is to end, if not as planned."""
        if phase is RISING or not self.widening:
            return None
        return OtherEnd(0.5 * self.widening, self.widths.pose_error(self.widening))

    def left(self, phase: StepPhase, sway: Sway) -> float:
        """Time left to the landing [s], from zero to 1.5 steps; a wider one comes later."""
        left, orbit, further = self.orbit.left(phase, sway.value, sway.rate), self.orbit, 0.5 * self.widening
        if not further:
            return left
        end = self._of_foot[self._stance].phases[FALLING].end
        if left == 0.0:
            return max(end + further - sway.value, 0.0) / max(sway.rate, SLOWEST)
        speed = float(np.sqrt(2.0 * max(orbit.energy(FALLING, end + 0.5 * further), SLOWEST**2)))
        return max(left + further / speed, 0.0)

    def _shift(self, phase: StepPhase, sway: Sway, unexplained: float) -> float:
        """How far the FRI target is moved for the energy [m]."""
        settings = self.settings.energy
        if settings is None:
            return 0.0
        bias, stance = self._bias, self._stance
        if self._since > settings.blank:
            bias[stance] += self._period / settings.average * (unexplained - bias[stance])
        # the foot rocks after a landing, and the estimate with it
        trust = between(0.0, self._since / settings.blank - 1.0, 1.0)
        orbit = self.orbit
        length = phase.sign * settings.length * orbit.ranges[phase]
        wanted = trust * orbit.error(phase, sway.value, sway.rate) / length - bias[stance]
        return -wanted / orbit.omega**2

    def _learn(self, sway: Sway) -> None:
        step = self._of_foot[self._stance]
        if self._fallen or sway.value < step.half_way:
            return
        self._fallen = True
        error = step.orbit.error(FALLING, sway.value, sway.rate)
        orbit = 0.5 * sway.rate**2 - error
        self.mid_fall = abs(sway.rate) / float(np.sqrt(2.0 * orbit)) - 1.0 if orbit > 0.0 else float("nan")
        if not abs(self.mid_fall) < DISTURBED:
            return
        learned = self.offset[self._stance] + self.settings.learning * error / step.energy_per_offset
        outer, inner = self._sole
        self.offset[self._stance] = float(np.clip(learned, LEARNED * outer, LEARNED * inner))
