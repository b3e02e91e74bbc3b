"""Samples and events of a simulated walk, collected into a trajectory."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.stance_motion import Reaction
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase


class Recorder:
    """Collects samples and events; every run is recorded here, whatever moves the robot or decides for it."""

    def __init__(self) -> None:
        self._rows: dict[str, list[Any]] = {name: [] for name in SAMPLED}
        self._events: list[tuple[float, str, int, FloatArray]] = []

    def sample(
        self,
        t: float,
        state: State,
        u: FloatArray,
        reaction: Reaction,
        *,
        p_fri_target: float,
        q_b_desired: FloatArray,
        phase: StepPhase,
        stance: Stance,
        stance_y: float,
        step: int,
    ) -> None:
        """Add a sample; units and shapes as in `Trajectory`."""
        values = {
            "t": t,
            "q": state.q,
            "dq": state.dq,
            "u": u,
            "force": reaction[:2],
            "p_fri": reaction.p_fri,
            "p_fri_target": p_fri_target,
            "q_b_desired": q_b_desired,
            "phase": phase.sign,
            "stance": stance.sign,
            "stance_y": stance_y,
            "step": float(step),
        }
        for name, value in values.items():
            self._rows[name].append(value)

    def event(self, t: float, kind: EventKind, step: int, state: State) -> None:
        """Add an event at time t [s], and the state right after it."""
        self._events.append((float(t), kind.name, step, np.concatenate(state)))

    def finish(
        self, robot: str, outcome: str, steps: int, gait: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> Trajectory:
        """The run; ``outcome`` is `trajectory.COMPLETED` or what made the robot fall."""
        times, kinds, event_steps, states = zip(*self._events, strict=True)
        return Trajectory(
            **{name: np.array(rows, dtype=float) for name, rows in self._rows.items()},
            event_t=np.array(times),
            event_kind=tuple(kinds),
            event_step=np.array(event_steps, dtype=float),
            event_state=np.array(states),
            robot=robot,
            outcome=outcome,
            steps_completed=steps,
            gait=dict(gait),
            settings=dict(settings),
        )
