"""A function of time and joints as a walker in the plane: phases and stance foot are told from the sensors here."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import PhaseEvent, Reading, WalkerCommand
from frontal_biped.control.joint_law import AskedLaw, JointLaw
from frontal_biped.control.walker.measured_state import measured_state
from frontal_biped.control.walker.phase_machine import PhaseMachine
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance


class LawWalker:
    """Answers readings with the torques of a `JointLaw` of the four roll joints; it knows no gait.

    Args:
        biped: the robot.
        law: of the user.
        period: time between readings [s].
    """

    def __init__(self, biped: FrontalBiped, law: JointLaw, period: float) -> None:
        self.biped, self.period = biped, period
        self._law = AskedLaw(law, biped.stance_map.joint_names, period)
        self._phases = PhaseMachine(period)
        self.stance = Stance.LEFT

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start right after an impact, standing on ``stance``."""
        self.stance = stance
        self._law.reset()
        self._phases.reset()
        self._q = q.copy()

    def tick(self, reading: Reading) -> WalkerCommand:
        """Torques for a reading, one period after the last.

        Raises:
            ControllerError: the law returns no torques; one line.
        """
        event: PhaseEvent | None = None
        q, dq = self._state(reading)
        touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        if self._phases.landing(touches, self.biped.swing_clearance(q)):
            event, self.stance = PhaseEvent.LANDING, self.stance.other
            q, dq = self._state(reading)
            self._q = q
        if event is None:
            event = self._phases.turn(float(dq[0]))
        self._q = q
        tau = self._law.torques(reading.time, reading.joint_positions, reading.joint_velocities)
        u = self.biped.stance_map.torques_to_stance(tau, self.stance)
        # it has no outputs and no target for the FRI
        return WalkerCommand(
            tau, self._phases.phase, self.stance, u, q, dq, np.zeros(3), float("nan"), solved=True, event=event
        )

    def _state(self, reading: Reading) -> tuple[FloatArray, FloatArray]:
        q, dq = measured_state(self.biped.stance_map, reading, self.stance)
        return q, (q - self._q) / self.period if dq is None else dq
