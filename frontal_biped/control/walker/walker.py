"""The walking robot's own controller: from what its sensors say to torques, with no simulator in sight.

At every reading: estimate the state (`StateEstimator`), decide whether the swing foot has landed (`PhaseMachine`),
predict the state at the time when the torques will act, decide there whether the robot has turned, ask the quadratic
program for the torques, with the FRI target moved so that the energy of the orbit is kept (`EnergyLaw`).

After a landing the virtual constraints begin at the predicted state at once, and again when the foot has settled and
the velocities after the impact have been seen.
"""

from collections import deque
from dataclasses import replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import QpController
from frontal_biped.control.interface import PhaseEvent, Reading, WalkerCommand
from frontal_biped.control.settings import ControllerSettings, sampled_frequency
from frontal_biped.control.stabilisers.by_name import make_stabiliser
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions, Stabiliser
from frontal_biped.control.walker.energy_law import EnergyLaw, EnergySettings
from frontal_biped.control.walker.estimator_gains import EstimatorSettings
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.control.walker.state_estimator import StateEstimator
from frontal_biped.exceptions import SimulationError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase

DEFAULT_ENERGY = EnergySettings()
"""How a walker keeps the energy of the orbit unless told otherwise."""

SETTLE = 0.03
"""Time after a landing when the virtual constraints begin anew [s]."""


class Walker:
    """Walks a gait from sensor readings alone; the same object drives any simulator, or a robot.

    Args:
        biped: the robot as the walker believes it to be.
        gait: what to walk.
        period: time between readings [s].
        settings: gains and limits; default: the gait's friction and normal force, the robot's own torque limits, and
            the gains of `sampled_frequency`.
        stabiliser: chooses the virtual constraints of each phase; an object or one of `STABILISERS` by name. Default:
            re-anchored transitions that leave the energy to the energy law, and rescale an early falling phase.
        delay: known time from a reading to the torques it leads to [s], a multiple of the period.
        phases: when to believe in a landing or a reversal.
        estimator: what to trust of the readings.
        energy: how the energy of the orbit is kept; None: it is left to the stabiliser.
        settle: time after a landing when the virtual constraints begin anew [s]; 0: never.

    Raises:
        SimulationError: the delay is no multiple of the period, or the stabiliser is unknown.
    """

    def __init__(
        self,
        biped: FrontalBiped,
        gait: Gait,
        *,
        period: float = 1e-3,
        settings: ControllerSettings | None = None,
        stabiliser: Stabiliser | str | None = None,
        delay: float = 0.0,
        phases: PhaseSettings | None = None,
        estimator: EstimatorSettings | None = None,
        energy: EnergySettings | None = DEFAULT_ENERGY,
        settle: float = SETTLE,
    ) -> None:
        self.biped, self.gait, self.period, self.delay = biped, gait, period, delay
        self._on_the_way = round(delay / period)
        if self._on_the_way < 0 or abs(self._on_the_way * period - delay) > 1e-6 * period:
            raise SimulationError(f"a delay of {delay:g} s is no multiple of the period of {period:g} s; make it one")
        if settings is None:
            limits = ControllerSettings.for_gait(gait)
            settings = replace(limits, max_torque=None, frequency=sampled_frequency(period))
        if stabiliser is None:
            alone = energy is None  # otherwise the energy law sees to the speed, and the transitions to the loads
            stabiliser = ReanchoringTransitions(biped, gait, anticipate=alone, rejoin=alone)
        chosen = make_stabiliser(stabiliser, biped, gait) if isinstance(stabiliser, str) else stabiliser
        self.controller = QpController(biped, gait, settings, chosen)
        self.phases = PhaseMachine(period, phases)
        self.estimator = StateEstimator(biped, period, estimator, delay)
        self.energy = None if energy is None else EnergyLaw(biped, gait, period, energy)
        self.settle = settle
        self.landings = 0
        self.reset(Stance.LEFT, *gait.state_after_impact())

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (4,) [rad], dq (4,) [rad/s]."""
        self.stance = stance
        self.estimator.reset(stance, q, dq)
        self.phases.reset()
        self._sent: deque[FloatArray] = deque(maxlen=self._on_the_way + 1)  # URDF order, the oldest acts now
        self._begun = False
        if self.energy is not None:
            self.energy.reset(stance)
        self._until_settled = np.inf

    def tick(self, reading: Reading) -> WalkerCommand:
        """Torques for a reading, one period after the last."""
        estimator = self.estimator
        if self._sent:
            estimator.predict(self._in_stance(self._sent[0]))
        event: PhaseEvent | None = None
        swing_touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        q, dq = self._measured(reading)
        clearance = self.biped.swing_clearance(q)
        if self.phases.landing(swing_touches, clearance):
            event = PhaseEvent.LANDING
            self.landings += 1
            estimator.land()
            if self.energy is not None:
                self.energy.land(self.stance.other)
            self.stance = self.stance.other
            q, dq = self._measured(reading)
        estimator.correct(q, dq)

        q, dq = estimator.ahead([self._in_stance(tau) for tau in list(self._sent)[1:]])
        if event is None:
            event = self.phases.turn(float(dq[0]))
        phase = self.phases.phase
        self._until_settled -= self.period
        settled = self._until_settled <= 0.0
        if event is not None or not self._begun or (settled and phase is StepPhase.RISING):
            self.controller.begin(phase, q, dq)
            self._begun = True
            landed = event is PhaseEvent.LANDING and self.settle > 0.0
            self._until_settled = self.settle if landed else np.inf
        shift = 0.0
        if self.energy is not None:
            shift = self.energy.fri_shift(phase, q, float(dq[0]), estimator.error)
        command = self.controller.command(phase, q, dq, shift)
        u = command.u
        tau = self.biped.stance_map.torques_to_urdf(u, self.stance)
        if not self._sent:  # nothing else was on its way
            self._sent.extend([tau] * self._on_the_way)
        self._sent.append(tau)
        return WalkerCommand(tau, phase, self.stance, u, q, dq, command.y, command.p_fri_target, command.solved, event)

    def counters(self) -> dict[str, int]:
        """What happened so far."""
        return {
            "ticks": self.controller.ticks,
            "unsolved": self.controller.unsolved,
            "declined": self.controller.declined,
            "landings": self.landings,
            "early_landings": self.phases.early_landings,
            "late_landings": self.phases.late_landings,
            "scuffs": self.phases.scuffs,
        }

    def _in_stance(self, tau: FloatArray) -> FloatArray:
        return self.biped.stance_map.torques_to_stance(tau, self.stance)

    def _measured(self, reading: Reading) -> tuple[FloatArray, FloatArray | None]:
        """Stance coordinates of a reading; the stance leg's absolute angle, whatever its foot does."""
        coordinates, stance = self.biped.stance_map, self.stance
        outwards = -stance.sign  # sense of +X in (h, v)
        q = coordinates.positions_to_stance(reading.joint_positions, stance).copy()
        q[0] = outwards * reading.base_roll + 2.0 * UPRIGHT - q[1]
        if reading.joint_velocities is None:
            return q, None
        dq = coordinates.velocities_to_stance(reading.joint_velocities, stance).copy()
        dq[0] = outwards * reading.base_roll_rate - dq[1]
        return q, dq
