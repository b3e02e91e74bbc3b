"""Samples and events of a walk in space, collected into a run."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.rows import Rows
from frontal_biped.simulation.space.run import SAMPLED, SpatialRun
from frontal_biped.simulation.space.soles import pressure_in_sole

_OF_WRENCHES = ("cop_x", "p_fri")


class SpatialRecorder:
    """Collects samples and events."""

    def __init__(self) -> None:
        self._rows = Rows(name for name in SAMPLED if name not in _OF_WRENCHES)
        self._events = Rows(("t", "step", "state"))
        self._kinds: list[str] = []

    def sample(self, values: Mapping[str, Any]) -> None:
        """Add a sample: a value of every array of `SAMPLED` that does not follow from the wrenches."""
        self._rows.add(values)

    def event(self, t: float, kind: EventKind, step: int, state: State) -> None:
        """Add an event at time t [s], and the frontal state right after it."""
        self._events.add({"t": t, "step": step, "state": np.concatenate(state)})
        self._kinds.append(kind.name)

    def finish(
        self, free: FreeRobot, outcome: str, steps: int, gait: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> SpatialRun:
        """The run; ``outcome`` is `trajectory.COMPLETED` or what made the robot fall."""
        # the state after an impact is taken when the contact has done its work, perhaps after the next event
        events = self._events.take()
        order = np.argsort(events["t"], kind="stable")
        arrays = self._rows.take()
        run = SpatialRun(
            **arrays,
            **dict.fromkeys(_OF_WRENCHES, np.full(len(arrays["t"]), np.nan)),
            event_t=events["t"][order],
            event_kind=tuple(self._kinds[i] for i in order),
            event_step=events["step"][order],
            event_frontal=events["state"][order],
            robot=free.name,
            joint_names=free.joint_names,
            locked=free.locked,
            outcome=outcome,
            steps_completed=steps,
            gait=dict(gait),
            settings=dict(settings),
        )
        pressure = pressure_in_sole(run)[np.arange(len(run.t)), np.where(run.stance > 0.0, 0, 1)]
        return replace(run, cop_x=pressure[:, 0], p_fri=-run.stance * pressure[:, 1])
