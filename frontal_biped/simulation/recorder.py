"""Samples and events of a simulated walk, collected into a trajectory."""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.model.perturbation import Plant
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.flows import Segment
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.pushes import PelvisForce, PushForces, along_h
from frontal_biped.simulation.trajectory import SAMPLED, Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase


class Recorder:
    """Collects samples and events.

    Args:
        plant: what moves.
        controller: asked again for the output and the FRI target of every sample.
        pushes: on the robot.
    """

    def __init__(self, plant: Plant, controller: Controller, pushes: PushForces) -> None:
        self.plant, self.controller, self.pushes = plant, controller, pushes
        self.pelvis = {stance: PelvisForce(plant.on(stance)) for stance in Stance}
        self.rows: dict[str, list[Any]] = {name: [] for name in SAMPLED}
        self.times: list[float] = []
        self.kinds: list[str] = []
        self.steps: list[int] = []
        self.states: list[FloatArray] = []

    def segment(self, segment: Segment, phase: StepPhase, stance: Stance, world_y: float, step: int) -> None:
        """Add the samples of a phase; ``world_y`` is where the stance foot stands [m]."""
        biped, pelvis = self.plant.on(stance), self.pelvis[stance]
        for i, (t, x) in enumerate(zip(segment.t, segment.x, strict=True)):
            q, dq = x[:4], x[4:]
            command = self.controller.command(phase, q, dq)
            u = command.u if segment.u is None else segment.u[i]
            pushes = [(along_h(force, stance), height) for force, height in self.pushes.at(t)]
            felt = u + sum((pelvis.torques(q, *push) for push in pushes), np.zeros(4))
            ddq = biped.forward_dynamics(q, dq, felt)
            wrench = biped.inverse_dynamics(q, dq, ddq)
            for force, height in pushes:  # the ground carries what the push does not
                wrench[0] -= force
                wrench[2] += force * pelvis.height(q, height)
            sample = {
                "t": t,
                "q": q,
                "dq": dq,
                "u": u,
                "force": wrench[:2],
                "p_fri": wrench[2] / wrench[1],
                "p_fri_target": command.p_fri_target,
                "q_b_desired": q[1:] - command.y,
                "phase": 1.0 if phase is StepPhase.RISING else -1.0,
                "stance": 1.0 if stance is Stance.LEFT else -1.0,
                "stance_y": world_y,
                "step": float(step),
            }
            for name, value in sample.items():
                self.rows[name].append(value)

    def event(self, t: float, kind: EventKind, step: int, state: FloatArray) -> None:
        """Add an event at time t [s] and state (8,)."""
        self.times.append(float(t))
        self.kinds.append(kind.name)
        self.steps.append(step)
        self.states.append(state.copy())

    def finish(
        self, robot: str, outcome: str, steps: int, gait: dict[str, Any], settings: dict[str, Any]
    ) -> Trajectory:
        """The run."""
        return Trajectory(
            **{name: np.array(rows, dtype=float) for name, rows in self.rows.items()},
            event_t=np.array(self.times),
            event_kind=tuple(self.kinds),
            event_step=np.array(self.steps, dtype=float),
            event_state=np.array(self.states),
            robot=robot,
            outcome=outcome,
            steps_completed=steps,
            gait=gait,
            settings=settings,
        )
