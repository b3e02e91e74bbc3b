"""What a walk of the whole robot in space is measured by."""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.scenarios.measured import largest, of_every_run, of_steps
from frontal_biped.scenarios.preparation import Prepared
from frontal_biped.scenarios.space_run import in_space
from frontal_biped.simulation.space.run import SpatialRun

LOADED = 0.1
"""Share of the weight that a foot carries where its friction and its centre of pressure are told: below that, the
contact of a landing rings."""


def spatial_measures(prepared: Prepared, run: SpatialRun) -> dict[str, float]:
    """Numbers of a walk in space, by the keys of `Expectations`; nan where there was nothing to measure."""
    free, _ = in_space(prepared)
    outer, inner = prepared.biped.sole
    sole = free.soles.left
    measured = run.settings.get("measured", {})
    force = run.wrench[:, :, :3]
    loaded = force[:, :, 2] > LOADED * free.weight
    stance = np.where(run.stance > 0.0, 0, 1)
    stands = loaded[np.arange(len(stance)), stance]
    p_fri, cop_x = run.p_fri[stands], run.cop_x[stands]
    return {
        "steps": float(run.steps_completed),
        "output_error": largest(np.abs(run.frontal_y)),
        "torque": _share(measured, "torque_share"),
        "joint_speed": _share(measured, "speed_share"),
        "friction": largest(np.hypot(force[loaded][:, 0], force[loaded][:, 1]) / force[loaded][:, 2]),
        "fri_margin": _margin(p_fri - outer, inner - p_fri),
        "cop_margin": _margin(cop_x + sole.back, sole.front - cop_x),
        "walking_speed": run.mean_speed(len(run.step_durations) // 2),
        "yaw_drift": float(run.yaw[-1] - run.yaw[0]) if len(run.yaw) else float("nan"),
        "self_collisions": float(measured.get("self_collision", {}).get("touching", 0)),
        "foot_slip": of_steps(measured, "slip"),
        "foot_rotation": of_steps(measured, "rotation"),
        **of_every_run(prepared, run),
    }


def _margin(*distances: FloatArray) -> float:
    return -largest(-np.minimum(*distances))


def _share(measured: Any, key: str) -> float:
    return float(measured[key]["largest"]) if key in measured else float("nan")
