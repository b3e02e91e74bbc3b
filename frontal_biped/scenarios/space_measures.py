"""What a walk of the whole robot in space is measured by."""

from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.scenarios.measured import largest, of_every_run, of_steps
from frontal_biped.scenarios.preparation import Prepared
from frontal_biped.scenarios.space_run import in_space
from frontal_biped.simulation.space.run import SpatialRun
from frontal_biped.simulation.space.soles import bearing, friction_used, pressure_in_sole, standing
from frontal_biped.simulation.space.steps import step_table
from frontal_biped.simulation.space.walk_path import missed

LOADED = 0.1
"""Share of the weight that a foot carries where its friction and centre of pressure count: below, a landing rings."""


def spatial_measures(prepared: Prepared, run: SpatialRun) -> dict[str, float]:
    """Numbers of a walk in space, by the keys of `Expectations`; nan where there was nothing to measure."""
    free, _ = in_space(prepared)
    measured, steps = run.settings.get("measured", {}), step_table(run)
    loaded = bearing(run) & (run.wrench[:, :, 2] > LOADED * free.weight)
    stands = loaded & standing(run)
    ahead, across = [], []
    for foot, sole in enumerate(free.soles):
        x, y = pressure_in_sole(run)[stands[:, foot], foot].T
        ahead += [x + sole.back, sole.front - x]
        outwards = sole.side.sign * y
        across += [outwards + sole.inner, sole.outer - outwards]
    second_half = slice(len(steps.step) // 2, None)
    return {
        "steps": float(run.steps_completed),
        "output_error": largest(np.abs(run.frontal_y)),
        "torque": _share(measured, "torque_share"),
        "joint_speed": _share(measured, "speed_share"),
        "friction": largest(friction_used(run)[loaded]),
        "fri_margin": -largest(-np.concatenate(across)),
        "cop_margin": -largest(-np.concatenate(ahead)),
        "walking_speed": _mean(steps.speed[second_half], steps.duration[second_half]),
        "yaw_drift": float(run.yaw[-1] - run.yaw[0]) if len(run.yaw) else float("nan"),
        "self_collisions": float(measured.get("self_collision", {}).get("touching", 0)),
        "foot_slip": of_steps(measured, "slip"),
        "foot_rotation": of_steps(measured, "rotation"),
        **_of_path(run),
        **of_every_run(prepared, run),
    }


def _of_path(run: SpatialRun) -> dict[str, float]:
    """What only a walk along a path has."""
    if "path" not in run.settings:
        return {}
    miss = missed(run)
    return {"path_distance": miss.distance, "path_angle": miss.angle}


def _mean(values: FloatArray, weights: FloatArray) -> float:
    return float(np.average(values, weights=weights)) if len(values) else float("nan")


def _share(measured: Any, key: str) -> float:
    return float(measured[key]["largest"]) if key in measured else float("nan")
