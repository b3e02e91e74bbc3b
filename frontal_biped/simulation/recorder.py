"""Samples and events of a simulated walk, collected into a trajectory."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from frontal_biped.arrays import FloatArray
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.rows import Rows
from frontal_biped.simulation.stance_motion import Reaction, Reactions
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase


class Recorder:
    """Collects samples and events; every run is recorded here, whatever moves the robot or decides for it."""

    def __init__(self) -> None:
        self._rows = Rows(SAMPLED)
        self._events = Rows(("t", "step", "state"))
        self._kinds: list[str] = []

    def copy(self) -> "Recorder":
        """What is recorded so far, to go on with."""
        twin = Recorder()
        twin._rows, twin._events, twin._kinds = self._rows.copy(), self._events.copy(), [*self._kinds]
        return twin

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
        values: dict[str, ArrayLike] = {
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
        self._rows.add(values)

    def samples(
        self,
        t: FloatArray,
        states: State,
        u: FloatArray,
        reactions: Reactions,
        *,
        p_fri_target: FloatArray,
        q_b_desired: FloatArray,
        phase: StepPhase,
        stance: Stance,
        stance_y: float,
        step: int,
    ) -> None:
        """Add the samples of a phase, (m, ...) each."""
        same = {"phase": phase.sign, "stance": stance.sign, "stance_y": stance_y, "step": float(step)}
        values = {
            "t": t,
            "q": states.q,
            "dq": states.dq,
            "u": u,
            "force": reactions.force,
            "p_fri": reactions.p_fri,
            "p_fri_target": p_fri_target,
            "q_b_desired": q_b_desired,
            **{name: np.full(len(t), value) for name, value in same.items()},
        }
        self._rows.add_many(values)

    def event(self, t: float, kind: EventKind, step: int, state: State) -> None:
        """Add an event at time t [s], and the state right after it."""
        self._events.add({"t": t, "step": step, "state": np.concatenate(state)})
        self._kinds.append(kind.name)

    def finish(
        self, robot: str, outcome: str, steps: int, gait: Mapping[str, Any], settings: Mapping[str, Any]
    ) -> Trajectory:
        """The run; ``outcome`` is `trajectory.COMPLETED` or what made the robot fall."""
        events = self._events.take()
        return Trajectory(
            **self._rows.take(),
            event_t=events["t"],
            event_kind=tuple(self._kinds),
            event_step=events["step"],
            event_state=events["state"],
            robot=robot,
            outcome=outcome,
            steps_completed=steps,
            gait=dict(gait),
            settings=dict(settings),
        )
