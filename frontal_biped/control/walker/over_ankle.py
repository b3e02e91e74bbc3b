"""The walker's outputs over the stance ankle's angle beta, the paper's phase variable, chosen anew by a stabiliser.

The FRI target moves so that the energy of the orbit is kept (`EnergyLaw`). After a landing the virtual constraints
begin at the predicted state at once, and again when the foot has settled and the velocities after the impact have been
seen.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.walker.energy_law import EnergyLaw
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.phase import StepPhase


class OverAnkle:
    """Outputs over beta.

    Args:
        controller: follows the phases its stabiliser chooses.
        energy: keeps the energy of the orbit; None: it is left to the stabiliser.
        period: time between ticks [s].
        settle: time after a landing when the virtual constraints begin anew [s]; 0: never.
    """

    def __init__(self, controller: QpController, energy: EnergyLaw | None, period: float, settle: float) -> None:
        self._controller, self._energy, self._period, self._settle = controller, energy, period, settle
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start right after an impact."""
        self._begun = False
        self._until_settled = np.inf
        if self._energy is not None:
            self._energy.reset(stance)

    def land(self, stance: Stance, state: State) -> None:
        """A foot has landed, with a state after the impact."""
        if self._energy is not None:
            self._energy.land(stance)

    def outwards(self, state: State) -> float:
        """Rate of the phase variable, positive where the robot sways outwards [rad/s]."""
        return float(state.dbeta)

    def command(self, phase: StepPhase, event: PhaseEvent | None, state: State, unexplained: FloatArray) -> Command:
        """Torques at a state.

        Args:
            phase: rising or falling.
            event: what was noticed in this tick, if anything.
            state: that the command is for.
            unexplained: (4,) acceleration that the model does not explain [rad/s^2].
        """
        q, dq = state
        self._until_settled -= self._period
        settled = self._until_settled <= 0.0
        if event is not None or not self._begun or (settled and phase is StepPhase.RISING):
            self._controller.begin(phase, q, dq)
            self._begun = True
            landed = event is PhaseEvent.LANDING and self._settle > 0.0
            self._until_settled = self._settle if landed else np.inf
        shift = 0.0
        if self._energy is not None:
            shift = self._energy.fri_shift(phase, q, float(dq[0]), unexplained)
        return self._controller.command(phase, q, dq, shift)
