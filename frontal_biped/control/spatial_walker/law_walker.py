"""A function of time and joints as a walker in space: phases and stance foot are told from the sensors here."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.frontal_law import TURNED
from frontal_biped.control.interface import PhaseEvent
from frontal_biped.control.joint_law import AskedLaw, JointLaw
from frontal_biped.control.spatial_walker.estimator import SpatialEstimator
from frontal_biped.control.spatial_walker.interface import SpatialCommand, SpatialReading
from frontal_biped.control.spatial_walker.walker import LIFTED
from frontal_biped.control.walker.phase_machine import PhaseMachine, PhaseSettings
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance


class SpatialLawWalker:
    """Answers readings with the torques of a `JointLaw` of every joint that moves; it knows no gait.

    Args:
        free: the robot.
        law: of the user.
        period: time between readings [s].
    """

    def __init__(self, free: FreeRobot, law: JointLaw, period: float) -> None:
        self._law = AskedLaw(law, free.joint_names, period)
        self._estimator, self._state = SpatialEstimator(free, period), SpaceState(free)
        self._phases = PhaseMachine(period, PhaseSettings(rate=TURNED, lifted=LIFTED))
        self._unmoved = np.zeros(free.model.nv)
        self.stance = Stance.LEFT

    def command(self, speed: float | None = None, lateral: float | None = None, turn: float | None = None) -> None:
        """Refuse any speed: the law decides where the robot goes.

        Raises:
            SimulationError: one is asked for.
        """
        for name, value in (("speed", speed), ("lateral", lateral), ("turn", turn)):
            if value:
                raise SimulationError(
                    f"{name} = {value:g}: a controller that is a function of (t, q, v) takes no commands; leave it out"
                )

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start right after an impact, standing on ``stance`` at q (nq,), v (nv,)."""
        self.stance = stance
        self._law.reset()
        self._phases.reset()
        self._estimator.reset(stance, q, v)

    def tick(self, reading: SpatialReading) -> SpatialCommand:
        """Torques for a reading, one period after the last.

        Raises:
            ControllerError: the law returns no torques; one line.
        """
        estimator = self._estimator
        estimator.predict(self._unmoved)
        estimator.correct(reading)
        event: PhaseEvent | None = None
        touches = reading.contact[1 if self.stance is Stance.LEFT else 0]
        if self._phases.landing(touches, estimator.clearance(self.stance.other)):
            event = PhaseEvent.LANDING
            estimator.land()
            self.stance = self.stance.other
        state = self._state.at(estimator.q, estimator.v)
        if event is None:
            event = self._phases.turn(-state.sway(self.stance).rate)
        seen = state.frontal(self.stance)
        tau = self._law.torques(reading.time, reading.joint_positions, reading.joint_velocities)
        return SpatialCommand(
            joint_torques=tau,
            phase=self._phases.phase,
            stance=self.stance,
            event=event,
            q=seen.q,
            dq=seen.dq,
            y=np.zeros(3),  # it has no outputs, and no targets either
            p_fri_target=float("nan"),
            cop_target_x=float("nan"),
            foothold=state.feet[self.stance.other].position.copy(),
            wrench=np.zeros(6),
            speed_target=0.0,
            solved=True,
            given_way="",
        )
