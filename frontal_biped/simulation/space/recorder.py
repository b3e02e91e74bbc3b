"""Samples and events of a walk in space, collected into a run."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.space.run import SAMPLED, SpatialRun
from frontal_biped.simulation.space.soles import pressure_in_sole

_OF_WRENCHES = ("cop_x", "p_fri")


class SpatialRecorder:
    """Collects samples and events."""

    def __init__(self) -> None:
        self._rows: dict[str, list[Any]] = {name: [] for name in SAMPLED if name not in _OF_WRENCHES}
        self._events: list[tuple[float, str, int, FloatArray]] = []

    def sample(self, values: Mapping[str, Any]) -> None:
        """Add a sample: a value of every array of `SAMPLED` that does not follow from the wrenches."""
        for name, rows in self._rows.items():
            rows.append(values[name])

    def event(self, t: float, kind: EventKind, step: int, state: State) -> None:
        """Add an event at time t [s], and the frontal state right after it."""
        self._events.append((float(t), kind.name, step, np.concatenate(state)))

    def finish(
        self, free: FreeRobot, outcome: str, steps: int, gait: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> SpatialRun:
        """The run; ``outcome`` is `trajectory.COMPLETED` or what made the robot fall."""
        # the state after an impact is taken when the contact has done its work, perhaps after the next event
        times, kinds, event_steps, states = zip(*sorted(self._events, key=lambda event: event[0]), strict=True)
        arrays = {name: np.array(rows, dtype=float) for name, rows in self._rows.items()}
        run = SpatialRun(
            **arrays,
            **dict.fromkeys(_OF_WRENCHES, np.full(len(arrays["t"]), np.nan)),
            event_t=np.array(times),
            event_kind=tuple(kinds),
            event_step=np.array(event_steps, dtype=float),
            event_frontal=np.array(states),
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
