"""Walk several steps in turn, again and again: a controller for each, changed at every impact."""

from collections.abc import Sequence

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import Command, QpController
from frontal_biped.control.interface import Commands
from frontal_biped.virtual_constraints.phase import StepPhase

TURNING = 1e-6
"""Rate of the stance ankle up to which a rising phase begins with a turn outwards, not with a landing [rad/s]."""


class StepsInTurn:
    """Controllers in the order in which they take their steps; after the last one the first goes on.

    Args:
        controllers: of the steps.
    """

    def __init__(self, controllers: Sequence[QpController]) -> None:
        self.controllers = tuple(controllers)
        self._step = 0
        self._phase = StepPhase.RISING

    @property
    def controller(self) -> QpController:
        """The one in charge."""
        return self.controllers[self._step % len(self.controllers)]

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]; a rising one that begins with a landing is the next step."""
        if phase is StepPhase.RISING and self._phase is StepPhase.FALLING and abs(dq[0]) > TURNING:
            self._step += 1
        self._phase = phase
        self.controller.begin(phase, q, dq)

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Command at q (4,) [rad], dq (4,) [rad/s]."""
        return self.controller.command(phase, q, dq)

    def commands(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Commands | None:
        """Commands at q (m, 4) [rad], dq (m, 4) [rad/s]; None: ask for them one by one."""
        return self.controller.commands(phase, q, dq)
