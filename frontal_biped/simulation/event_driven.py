"""Simulate the full model in closed loop, event by event, under a controller that is told state and events.

Continuous: the controller is evaluated inside the integrator, the oracle of everything sampled. Sampled: a zero-order
hold at a fixed period, as on a robot; joint torques stay constant through an impact until the next tick. Events are
located, not stepped over. Noise, pushes and the other disturbances act on sampled runs (see `disturbances`).
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from frontal_biped.arrays import FloatArray
from frontal_biped.control.interface import Controller
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.hybrid_system import Guard
from frontal_biped.simulation.loop import PHASE_TIME_LIMIT, TIMED_OUT, TOO_STIFF, Steps, run_sampled
from frontal_biped.simulation.motors import Motors
from frontal_biped.simulation.pushes import PushForces
from frontal_biped.simulation.recorder import Recorder
from frontal_biped.simulation.rigid import RigidEngine
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.simulation.state_fed import StateFed, Told
from frontal_biped.simulation.trajectory import Trajectory

MOST_EVALUATIONS = 8_000
"""Of the controller in one continuous phase: a phase of a walk takes about a thousand, one that falls up to 4000."""


def simulate_walk(
    biped: FrontalBiped,
    controller: Controller,
    start: State,
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
        start: state after the impact.
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
    engine, recorder = RigidEngine(biped, errors, chosen), Recorder()
    pushes = PushForces(chosen.disturbances.pushes)
    steps = Steps(engine, chosen.steps, chosen.landing_heights, pushes, recorder, on_step)
    engine.place(stance, start)
    steps.start(stance)
    told = Told(engine, controller, steps, pushes, recorder)
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
    """Walk with the controller inside the right-hand side, DOP853 with located events; the outcome."""
    engine, controller, t = told.engine, told.controller, 0.0
    controller.begin(engine.phase, *engine.state)
    n = len(engine.state.q)
    while True:
        segment = told.segment(t)
        biped, phase = engine.motion.biped, engine.phase

        asked, given_up = 0, np.inf

        def derivative(time: float, x: FloatArray) -> FloatArray:
            nonlocal asked, given_up
            asked += 1
            if asked > MOST_EVALUATIONS:
                given_up = min(given_up, time)
            q, dq = x[:n], x[n:]
            u = controller.command(phase, q, dq).u  # noqa: B023, the phase of this segment
            return np.concatenate([dq, biped.forward_dynamics(q, dq, u)])  # noqa: B023

        def patience(time: float, _: FloatArray) -> float:
            return given_up - time  # noqa: B023

        patience.terminal = True  # type: ignore[attr-defined]
        solution = solve_ivp(
            derivative,
            (t, t + PHASE_TIME_LIMIT),
            np.concatenate(engine.state),
            method="DOP853",
            rtol=settings.rtol,
            atol=settings.atol,
            events=[*(_as_event(guard) for guard in engine.guards), patience],
            dense_output=True,
        )
        assert solution.sol is not None  # dense_output=True
        assert solution.t_events is not None  # there are events
        end = float(solution.t[-1])
        count = max(2, int(np.ceil((end - t) * settings.record_rate)) + 1)
        times = np.linspace(t, end, count)
        x = solution.sol(times).T
        x[0], x[-1] = np.concatenate(engine.state), solution.y[:, -1]
        segment.t[:], segment.states[:] = times, [State(row[:n], row[n:]) for row in x]
        told.record(segment)
        if solution.status != 1:
            return TIMED_OUT
        *found, gave_up = solution.t_events
        if len(gave_up):
            return TOO_STIFF
        hits = zip(engine.guards, found, strict=True)
        kind, t = next(guard.kind for guard, times in hits if len(times)), end
        engine.state = segment.states[-1]
        outcome = told.passed(t, kind, engine.cross(kind), engine.state)
        if outcome is not None:
            return outcome


def _as_event(guard: Guard) -> Callable[[float, FloatArray], float]:
    def event(_: float, x: FloatArray) -> float:
        half = len(x) // 2
        return guard.function(x[:half], x[half:])

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = guard.direction  # type: ignore[attr-defined]
    return event
