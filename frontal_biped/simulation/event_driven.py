"""Simulate the full model in closed loop, event by event.

Continuous: the controller is evaluated inside the integrator. Sampled: a zero-order hold at a fixed period, as on a
robot; joint torques stay constant through an impact until the next tick. Events are located, not stepped over.
Noise, pushes and the other disturbances act on sampled runs (see `disturbances`).
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors, Plant
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.flows import PHASE_TIME_LIMIT, ContinuousFlow, SampledFlow
from frontal_biped.simulation.hybrid_system import EventKind, Guards, land, walking_guards
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase

TIMED_OUT = f"a phase lasted longer than {PHASE_TIME_LIMIT:g} s"
MOST_TURNS = 20  # times a push may turn the robot outwards again within one step


def simulate_walk(
    biped: FrontalBiped,
    controller: Controller,
    q0: FloatArray,
    dq0: FloatArray,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    gait: Mapping[str, Any] | None = None,
    controller_settings: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        biped: the robot as the controller knows it.
        controller: commands torques.
        q0: (4,) configuration after the impact [rad].
        dq0: (4,) velocities after the impact [rad/s].
        settings: of the simulator.
        errors: how the robot that is simulated differs from ``biped``.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        gait: content of the gait file, kept with the run.
        controller_settings: kept with the run.

    Returns:
        The run; a fall is an outcome, not an error.
    """
    chosen = settings or SimulationSettings()
    plant = Plant.of(biped, errors)
    pushes = PushForces(chosen.disturbances.pushes)
    flow = (
        ContinuousFlow(plant, controller, chosen)
        if chosen.period is None
        else SampledFlow(plant, biped, controller, chosen, pushes)
    )
    recorder = Recorder(plant, controller, pushes)
    # the ground under the feet: start, start, then one height for every landing, and one that is never reached
    ground = np.concatenate([np.zeros(2), chosen.disturbances.landing_heights(chosen.steps + 1)])
    state = np.concatenate([q0, dq0])
    flow.begin(state)
    t, phase, step, outcome = 0.0, StepPhase.RISING, 0, "completed"
    # the feet start level about y = 0, as in a walk on the spot
    world_y = (1.0 if stance is Stance.LEFT else -1.0) * 0.5 * float(plant.on(stance).joint_positions(q0)[3, 0])
    recorder.event(t, EventKind.IMPACT, -1, state)
    turns = 0
    guards = _guards(plant, stance, ground, step)
    pushes.begin(t, step, phase)
    controller.begin(phase, *flow.perceived(state))
    while step < chosen.steps:
        active = guards.rising if phase is StepPhase.RISING else guards.falling
        segment = flow.run(t, state, phase, active, stance)
        recorder.segment(segment, phase, stance, world_y, step)
        t, state = segment.t[-1], segment.x[-1]
        if segment.event is EventKind.REVERSAL:
            phase = StepPhase.FALLING
            recorder.event(t, EventKind.REVERSAL, step, state)
            if float(plant.on(stance).swing_sole(state[:4])[:, 1].min()) < ground[step + 2] - ground[step + 1]:
                outcome = EventKind.EARLY_LANDING.value
                recorder.event(t, EventKind.EARLY_LANDING, step, state)
                break
            pushes.begin(t, step, phase)
            controller.begin(phase, *flow.perceived(state))
        elif segment.event is EventKind.TURNED_OUTWARDS and turns < MOST_TURNS:
            phase, turns = StepPhase.RISING, turns + 1
            recorder.event(t, EventKind.TURNED_OUTWARDS, step, state)
            controller.begin(phase, *flow.perceived(state))
        elif segment.event is EventKind.IMPACT:
            stood = plant.on(stance)
            landing = land(stood, state[:4], state[4:], chosen.flat_landing)
            if landing is not None and landing.friction_used > (chosen.disturbances.friction or np.inf):
                recorder.event(t, EventKind.SLIPPED, step, state)
                outcome = EventKind.SLIPPED.value
                break
            if landing is None:
                recorder.event(t, EventKind.EDGE_LANDING, step, state)
                outcome = EventKind.EDGE_LANDING.value
                break
            width = float(stood.joint_positions(state[:4])[3, 0])
            world_y -= width if stance is Stance.LEFT else -width
            stance, phase, step, turns = stance.other, StepPhase.RISING, step + 1, 0
            state = np.concatenate([landing.q_plus, landing.dq_plus])
            flow.land(state)
            guards = _guards(plant, stance, ground, step)
            pushes.begin(t, step, phase)
            controller.begin(phase, *flow.perceived(state))
            recorder.event(t, EventKind.IMPACT, step - 1, state)
            if on_step is not None:
                on_step(step)
        else:
            outcome = TIMED_OUT if segment.event is None else segment.event.value
            if segment.event is not None:
                recorder.event(t, segment.event, step, state)
            break
    stored = {
        **asdict(chosen),
        "disturbances": chosen.disturbances.as_dict(),
        "errors": None if errors is None else errors.as_dict(),
        "controller": dict(controller_settings or {}),
    }
    return recorder.finish(biped.name, outcome, step, dict(gait or {}), stored)


def _guards(plant: Plant, stance: Stance, ground: FloatArray, step: int) -> Guards:
    """Guards of a step (from 0): foothold ``step`` is left, ``step + 1`` stood on, ``step + 2`` landed on."""
    return walking_guards(plant.on(stance), ground[step] - ground[step + 1], ground[step + 2] - ground[step + 1])
