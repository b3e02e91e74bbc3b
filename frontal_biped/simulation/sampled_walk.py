"""A sampled walk under way: it can stop before a tick and go on from there in copies, each with pushes of its own.

Walks that are pushed at one instant are one walk up to that instant. A copy goes on with the values of the original, so
its motion is, to the last bit, that of a walk with the copy's pushes from the start.
"""

from collections.abc import Sequence
from copy import copy, deepcopy
from dataclasses import replace

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.simulation.engine import Move
from frontal_biped.simulation.loop import TIMED_OUT, Decision, run_sampled
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import Push, PushForces
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.state_fed import StateFed, Told


class SampledWalk:
    """A walk under a controller that is told state and events, at a fixed period.

    Args:
        told: tells the controller, moves the robot and records.
        pushes: of the run.
        settings: of the simulator, with a period.

    Attributes:
        told: as given.
        settings: as given.
        outcome: `COMPLETED` or what made the robot fall; None while it walks.
    """

    def __init__(self, told: Told, pushes: PushForces, settings: SimulationSettings) -> None:
        assert settings.period is not None
        self.told, self.settings = told, settings
        self.outcome: str | None = None
        self._pushes, self._period = pushes, settings.period
        self._motors = Motors(settings.disturbances, settings.period, told.engine.biped.max_torque)
        self._pilot = StateFed(told, settings, self._motors)
        self._tick = 0

    def walk(self) -> str:
        """Walk to the end; the outcome."""
        if self.outcome is None:
            self.outcome = self._run(self._pilot)
            if self.outcome == TIMED_OUT:
                self._pilot.record()
        return self.outcome

    def walk_until(self, t: float) -> None:
        """Walk on up to the last tick that is not after time t [s], unless the walk ends before."""
        if self.outcome is None:
            pilot = _Stopping(self._pilot, t - self._period)
            outcome = self._run(pilot)
            if pilot.stopped:
                self._tick = round(pilot.now / self._period)
            else:
                self.outcome = outcome

    def _run(self, pilot: "StateFed | _Stopping") -> str:
        return run_sampled(self.told.engine, pilot, self._motors, self._pushes, self._period, self._tick)

    def copy(self, controller: Controller, pushes: Sequence[Push]) -> "SampledWalk":
        """The walk so far, to go on by itself.

        Args:
            controller: one that has been told what this walk's has.
            pushes: of the copy, as of a run from its start; none of them has begun yet.

        Raises:
            SimulationError: the sensors are noisy.
        """
        twin = copy(self)
        twin.settings = replace(self.settings, disturbances=replace(self.settings.disturbances, pushes=tuple(pushes)))
        twin._pushes, twin._motors = self._pushes.replaced(pushes), deepcopy(self._motors)
        twin.told = self.told.continued(controller, twin._pushes)
        twin._pilot = self._pilot.continued(twin.told, twin._motors)
        return twin


class _Stopping:
    """A pilot that stops the walk before it decides at the first tick after a time [s]."""

    def __init__(self, pilot: StateFed, last: float) -> None:
        self._pilot, self._last = pilot, last
        self.stopped, self.now = False, 0.0

    @property
    def since(self) -> float:
        return self._pilot.since

    def decide(self, t: float) -> Decision | None:
        self.now, self.stopped = t, t > self._last
        return None if self.stopped else self._pilot.decide(t)

    def sent(self, t: float, tau: FloatArray) -> None:
        self._pilot.sent(t, tau)

    def moved(self, move: Move) -> str | None:
        return self._pilot.moved(move)
