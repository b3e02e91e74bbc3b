"""The periodic orbit of a gait as a run: what the robot does undisturbed, straight from the zero dynamics."""

import numpy as np
from scipy.interpolate import CubicSpline

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory
from frontal_biped.virtual_constraints.phase import Phase, StepPhase
from frontal_biped.zero_dynamics.orbit import PhaseOrbit, resample
from frontal_biped.zero_dynamics.restricted import F_H, F_V, TORQUES

ORBIT = "periodic orbit"
"""``settings["source"]`` of a run that was not simulated."""


def orbit_trajectory(biped: FrontalBiped, gait: Gait, steps: int = 4, samples: int = 121) -> Trajectory:
    """Repeat the periodic orbit of a gait.

    Args:
        biped: the robot.
        gait: the gait.
        steps: number of steps, the first on the left foot.
        samples: points of a phase.

    Returns:
        A run whose joints are on the virtual constraints exactly.
    """
    step = gait.step(biped)
    tau = np.linspace(0.0, 1.0, samples)
    rising = _phase_samples(biped, gait.rising, resample(biped, gait.rising, step.rising, tau))
    falling = _phase_samples(biped, gait.falling, resample(biped, gait.falling, step.falling, tau))
    falling["t"] = falling["t"] + rising["t"][-1]
    one = {name: np.concatenate([rising[name], falling[name]]) for name in rising}
    duration, size = one["t"][-1], len(one["t"])

    index = np.repeat(np.arange(steps), size).astype(float)
    stance = 1.0 - 2.0 * (index % 2.0)  # left first
    arrays = {name: np.concatenate([values] * steps) for name, values in one.items()}
    arrays["t"] = arrays["t"] + index * duration
    starts = np.arange(steps) * duration
    q, dq = gait.state_after_impact()
    reversed_state = np.concatenate([one["q"][samples], np.zeros(4)])
    return Trajectory(
        **arrays,
        q_b_desired=arrays["q"][:, 1:].copy(),
        p_fri_target=arrays["p_fri"].copy(),
        stance=stance,
        stance_y=0.5 * gait.step_width * stance,
        step=index,
        event_t=np.append(np.stack([starts, starts + rising["t"][-1]], axis=1).ravel(), steps * duration),
        event_kind=("IMPACT", "REVERSAL") * steps + ("IMPACT",),
        event_step=np.array([-1.0, *(float(k) for k in range(steps) for _ in range(2))]),
        event_state=np.array([np.concatenate([q, dq]), reversed_state] * steps + [np.concatenate([q, dq])]),
        robot=biped.name,
        outcome=COMPLETED,
        steps_completed=steps,
        gait={"specification": gait.specification.as_dict()},
        settings={"source": ORBIT},
    )


def _phase_samples(biped: FrontalBiped, phase: Phase, orbit: PhaseOrbit) -> dict[str, FloatArray]:
    """Samples of one phase in the order of time, which starts at 0."""
    from_reversal = CubicSpline(orbit.tau, orbit.time_density).antiderivative()(orbit.tau)
    rising = orbit.kind is StepPhase.RISING
    order = slice(None, None, -1) if rising else slice(None)
    t = (from_reversal[-1] - from_reversal) if rising else from_reversal
    forces = orbit.generalized_forces
    samples = {
        "t": t,
        "q": orbit.motion.q,
        "dq": orbit.motion.dq * orbit.dbeta[:, None],
        "u": forces[TORQUES].T,
        "force": forces[[F_H, F_V]].T,
        "p_fri": orbit.motion.p_fri,
        "phase": np.full(len(t), orbit.kind.sign),
    }
    return {name: np.ascontiguousarray(values[order]) for name, values in samples.items()}
