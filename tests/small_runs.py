"""Small runs, planar and in space, of random numbers that a run file may hold: for what is read and written."""

import numpy as np

from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.trajectory import Trajectory

SAMPLES = 5
TIME = np.array([0.0, 0.25, 0.5, 0.5, 1.0])
"""With the two samples of an event."""

EVENTS = {
    "event_t": np.array([0.0, 1.0]),
    "event_kind": ("IMPACT", "REVERSAL"),
    "event_step": np.zeros(2),
    "outcome": "completed",
    "steps_completed": 1,
    "settings": {"plant": {"friction": 0.8}},
}
PHASES = {
    "t": TIME,
    "phase": np.array([1.0, 1.0, 1.0, -1.0, -1.0]),
    "stance": np.ones(SAMPLES),
    "step": np.zeros(SAMPLES),
}


def planar_run() -> Trajectory:
    """One step, without a gait."""
    normal = np.random.default_rng(0).normal
    rows = {"q": 4, "dq": 4, "u": 4, "force": 2, "q_b_desired": 3}
    arrays = {name: normal(size=(SAMPLES, count)) for name, count in rows.items()}
    arrays |= {name: normal(size=SAMPLES) for name in ("p_fri", "p_fri_target", "stance_y")}
    return Trajectory(**PHASES, **EVENTS, **arrays, event_state=normal(size=(2, 8)), robot="frontal_biped")


def spatial_run() -> SpatialRun:
    """The same of a robot with two joints."""
    normal = np.random.default_rng(0).normal
    rows = {
        "q": (9,), "v": (8,), "tau": (2,), "wrench": (2, 6), "com": (3,), "com_velocity": (3,), "sole_position": (2, 3),
        "sole_yaw": (2,), "frontal_q": (4,), "frontal_dq": (4,), "frontal_y": (3,), "foothold": (3,),
        "p_fri": (), "p_fri_target": (), "cop_x": (), "cop_target_x": (), "speed_target": (), "yaw": (),
    }  # fmt: skip
    arrays = {name: normal(size=(SAMPLES, *row)) for name, row in rows.items()}
    arrays["q"][:, 3:7] /= np.linalg.norm(arrays["q"][:, 3:7], axis=1, keepdims=True)
    return SpatialRun(
        **PHASES,
        **EVENTS,
        **arrays,
        contact=np.tile([1.0, 0.0], (SAMPLES, 1)),
        solved=np.ones(SAMPLES),
        event_frontal=normal(size=(2, 8)),
        robot="two_joints",
        joint_names=("hip", "ankle"),
        locked=("finger",),
    )
