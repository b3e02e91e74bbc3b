"""Simulate the full model in closed loop, event by event, under a controller that is told state and events.

Continuous (`continuous`): the controller acts at every instant, the oracle of everything sampled. Sampled: a zero-order
hold at a fixed period, as on a robot; joint torques stay constant through an impact until the next tick. Events are
located, not stepped over. Noise, pushes and the other disturbances act on sampled runs (see `disturbances`).
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.continuous import PhaseFlow, follow_phase
from frontal_biped.simulation.loop import Steps
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.rigid import RigidEngine
from frontal_biped.simulation.sampled_walk import SampledWalk
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.state_fed import Told
from frontal_biped.simulation.trajectory import Trajectory
from frontal_biped.virtual_constraints.phase import StepPhase


def simulate_walk(
    biped: FrontalBiped,
    controller: Controller,
    start: State,
    settings: SimulationSettings | None = None,
    *,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    enough: Callable[[FloatArray], bool] | None = None,
    gait: Mapping[str, Any] | None = None,
    controller_settings: Mapping[str, Any] | None = None,
) -> Trajectory:
    """Walk from a state right after an impact.

    Args:
        biped: the robot as the controller knows it.
        controller: commands torques.
        start: state after the impact.
        settings: of the simulator.
        errors: how the robot that is simulated differs from ``biped``.
        stance: the first stance foot.
        on_step: called with the number of completed steps.
        enough: asked after every step, given the post-impact speeds so far (k,) [rad/s], the start's first: may the
            walk end here?
        gait: content of the gait file, kept with the run.
        controller_settings: kept with the run.

    Returns:
        The run; a fall is an outcome, not an error.
    """
    chosen = settings or SimulationSettings()
    recorder, pushes = Recorder(), PushForces(chosen.disturbances.pushes)
    told = _standing(biped, controller, start, chosen, pushes, recorder, errors, stance, on_step, enough)
    sampled = chosen.period is not None
    outcome = SampledWalk(told, pushes, chosen).walk() if sampled else _run_continuously(told, chosen)
    stored = {
        **asdict(chosen),
        "disturbances": chosen.disturbances.as_dict(),
        "errors": None if errors is None else errors.as_dict(),
        "controller": dict(controller_settings or {}),
    }
    return recorder.finish(biped.name, outcome, told.steps.count, gait or {}, stored)


def begin_walk(
    biped: FrontalBiped,
    controller: Controller,
    start: State,
    settings: SimulationSettings,
    enough: Callable[[FloatArray], bool] | None = None,
) -> SampledWalk:
    """A sampled walk that begins right after an impact, to be walked as far as wanted; arguments of `simulate_walk`."""
    recorder, pushes = Recorder(), PushForces(settings.disturbances.pushes)
    told = _standing(biped, controller, start, settings, pushes, recorder, enough=enough)
    return SampledWalk(told, pushes, settings)


def _standing(
    biped: FrontalBiped,
    controller: Controller,
    start: State,
    settings: SimulationSettings,
    pushes: PushForces,
    recorder: Recorder,
    errors: ModelErrors | None = None,
    stance: Stance = Stance.LEFT,
    on_step: Callable[[int], None] | None = None,
    enough: Callable[[FloatArray], bool] | None = None,
) -> Told:
    """The robot in its first state, and what tells its controller of the walk."""
    engine = RigidEngine(biped, errors, settings)
    steps = Steps(engine, settings.steps, settings.landing_heights, pushes, recorder, on_step)
    engine.place(stance, start)
    steps.start(stance)
    return Told(engine, controller, steps, pushes, recorder, enough)


def _run_continuously(told: Told, settings: SimulationSettings) -> str:
    """Walk with the controller in charge at every instant; the outcome."""
    engine, controller, t = told.engine, told.controller, 0.0
    controller.begin(engine.phase, *engine.state)
    n, flows = len(engine.state.q), dict[StepPhase, PhaseFlow]()
    while True:
        segment = told.segment(t)
        plant, tolerances, like = engine.motion.biped, (settings.rtol, settings.atol), flows.get(engine.phase)
        flow = follow_phase(controller, plant, engine.phase, t, engine.state, engine.guards, *tolerances, like)
        flows[engine.phase] = flow
        began, (t, state, why) = t, flow.ended
        times = np.linspace(began, t, max(2, int(np.ceil((t - began) * settings.record_rate)) + 1))
        x = flow.samples(times)
        segment.t[:], segment.states[:] = times, [State(row[:n], row[n:]) for row in x]
        told.record(segment)
        if isinstance(why, str):
            return why
        engine.state = state
        outcome = told.passed(t, why, engine.cross(why), engine.state)
        if outcome is not None:
            return outcome
