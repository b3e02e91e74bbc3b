"""Walk one gait after another: a controller for each, changed at impacts."""

from collections.abc import Sequence

from frontal_biped.arrays import FloatArray
from frontal_biped.control.controller import Command, QpController
from frontal_biped.virtual_constraints.phase import StepPhase


class GaitSequence:
    """Controllers in the order in which they take over.

    Args:
        parts: each controller with the number of steps it walks; the last one goes on for ever.
    """

    def __init__(self, parts: Sequence[tuple[QpController, int]]) -> None:
        self.parts = tuple(parts)
        self._part = self._step = 0
        self._phase = StepPhase.RISING

    @property
    def controller(self) -> QpController:
        """The one in charge."""
        return self.parts[self._part][0]

    def begin(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> None:
        """A phase begins at q (4,) [rad], dq (4,) [rad/s]."""
        self._enter(phase)
        self.controller.begin(phase, q, dq)

    def command(self, phase: StepPhase, q: FloatArray, dq: FloatArray) -> Command:
        """Command at q (4,) [rad], dq (4,) [rad/s]; a falling phase followed by a rising one is a step."""
        self._enter(phase)
        return self.controller.command(phase, q, dq)

    def _enter(self, phase: StepPhase) -> None:
        if phase is StepPhase.RISING and self._phase is StepPhase.FALLING:
            self._step += 1
            if self._step >= self.parts[self._part][1] and self._part + 1 < len(self.parts):
                self._part, self._step = self._part + 1, 0
        self._phase = phase
