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
from frontal_biped.simulation.continuous import follow_phase
from frontal_biped.simulation.loop import TIMED_OUT, Steps, run_sampled
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.rigid import RigidEngine
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.state_fed import StateFed, Told
from frontal_biped.simulation.trajectory import Trajectory


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
    engine, recorder = RigidEngine(biped, errors, chosen), Recorder()
    pushes = PushForces(chosen.disturbances.pushes)
    steps = Steps(engine, chosen.steps, chosen.landing_heights, pushes, recorder, on_step)
    engine.place(stance, start)
    steps.start(stance)
    told = Told(engine, controller, steps, pushes, recorder, enough)
    if chosen.period is None:
        outcome = _run_continuously(told, chosen)
    else:
        motors = Motors(chosen.disturbances, chosen.period, biped.max_torque)
        pilot = StateFed(told, chosen, motors)
        outcome = run_sampled(engine, pilot, motors, pushes, chosen.period)
        if outcome == TIMED_OUT:
            pilot.record()
    stored = {
        **asdict(chosen),
        "disturbances": chosen.disturbances.as_dict(),
        "errors": None if errors is None else errors.as_dict(),
        "controller": dict(controller_settings or {}),
    }
    return recorder.finish(biped.name, outcome, steps.count, gait or {}, stored)


def _run_continuously(told: Told, settings: SimulationSettings) -> str:
    """Walk with the controller in charge at every instant; the outcome."""
    engine, controller, t = told.engine, told.controller, 0.0
    controller.begin(engine.phase, *engine.state)
    n = len(engine.state.q)
    while True:
        segment = told.segment(t)
        plant, tolerances = engine.motion.biped, (settings.rtol, settings.atol)
        flow = follow_phase(controller, plant, engine.phase, t, engine.state, engine.guards, *tolerances)
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
