"""The periodic orbit of a gait as a run: what the robot does undisturbed, straight from the zero dynamics."""

import numpy as np

from frontal_biped.gait.gait import Gait
from frontal_biped.gait.orbit_samples import phase_samples
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.simulation.trajectory import COMPLETED, Trajectory

VIEWED_STEPS = 6
"""Of a gait that is shown."""

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
    rising = phase_samples(biped, gait.rising, step.rising, tau)._asdict()
    falling = phase_samples(biped, gait.falling, step.falling, tau)._asdict()
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
