"""Follow a gait along its solution branch from the specification it has to another one.

Specifications are blended linearly; every gait starts the next design. A step that fails, or lands far from where it
started, is halved: the branch is followed, not left for another one. Where no step is small enough the branch ends,
and the explanation of the last failure says what ends it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from frontal_biped.design.optimise import OPTIMISER_NODES, DesignResult, optimise_gait
from frontal_biped.design.problem import DesignProblem
from frontal_biped.gait.constraints import energy_margin, reversal_shift
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.holding_wrench import step_holding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped

JUMP = 5.0
"""Change of a variable, in units of its scale, that a single step of a branch must not exceed."""


@dataclass(frozen=True)
class Branch:
    """A solution branch.

    Attributes:
        results: the designs on it, first the one nearest to the given gait.
        fractions: of the way from the gait's specification to the target, one a result.
        reached: the last fraction; 1 where the target was reached.
        message: one line; where the branch ends short of the target, what ends it.
    """

    results: tuple[DesignResult, ...]
    fractions: tuple[float, ...]
    reached: float
    message: str

    @property
    def complete(self) -> bool:
        """Does the branch reach the target?"""
        return self.reached == 1.0

    @property
    def gaits(self) -> tuple[Gait, ...]:
        """The gaits on it."""
        return tuple(result.gait for result in self.results if result.gait is not None)


def follow_branch(
    biped: FrontalBiped,
    gait: Gait,
    target: GaitSpecification,
    *,
    step: float = 0.25,
    min_step: float = 1.0 / 64.0,
    on_gait: Callable[[float, Gait], None] | None = None,
) -> Branch:
    """Continue a gait to another specification.

    Args:
        biped: the robot.
        gait: where the branch begins.
        target: where it should lead; its degrees hold from the first step on.
        step: first and largest step, a fraction of the way.
        min_step: smallest step; below it the branch ends.
        on_gait: called with fraction and gait after every step.

    Returns:
        The branch.
    """
    origin = attained(biped, gait, target)
    results: list[DesignResult] = []
    fractions: list[float] = []
    reached, current = 0.0, gait
    message = "the branch reaches the target"
    size = step
    while reached < 1.0:
        ahead = min(1.0, reached + size)
        if 1.0 - ahead < 0.5 * min_step:
            ahead = 1.0
        specification = target if ahead == 1.0 else blend(origin, target, ahead)
        result = optimise_gait(biped, specification, start=current, fall_back=False, advise=size <= min_step)
        if result.gait is not None and (not _jumped(biped, specification, current, result.gait) or not results):
            results.append(result)
            fractions.append(ahead)
            reached, current = ahead, result.gait
            size = min(step, 2.0 * size)
            if on_gait is not None:
                on_gait(reached, current)
        elif size <= min_step:
            cause = result.message if result.gait is None else "the nearest gait lies on another branch"
            message = f"the branch ends at {100.0 * reached:.1f} % of the way: {cause}"
            break
        else:
            size = max(0.5 * size, min_step)
    return Branch(tuple(results), tuple(fractions), reached, message)


def attained(biped: FrontalBiped, gait: Gait, target: GaitSpecification) -> GaitSpecification:
    """The gait's specification, with bounds that only the target has set to what the gait attains."""
    own = gait.specification
    table = own.as_dict()
    step = gait.step(biped)
    poses = np.concatenate([orbit.motion.q for orbit in (step.rising, step.falling)])
    values: dict[str, Any] = {
        "max_pelvis_roll": float(np.max(np.abs(biped.pelvis_roll(poses)))),
        "max_foot_rotation": float(np.max(np.abs(biped.swing_foot_rotation(poses)))),
        "max_torque": [float(limit) for limit in biped.max_torque],
        "max_multiplier": float(step.multiplier),
        "min_energy_margin": float(energy_margin(step)),
        "max_reversal_shift": float(reversal_shift(step)),
    }
    if target.bounds_holding_wrench:
        wrenches = [wrench for phase in step_holding(biped, step) for wrench in phase]
        rooms = [np.minimum(at.sole.front - at.cop_x, at.sole.back + at.cop_x) for at in wrenches]
        values["cop_margin_x"] = float(np.min(rooms))
        values["yaw_friction"] = float(np.max(np.abs([at.friction for at in wrenches])))
        if values["cop_margin_x"] < 0.0:  # no specification can say so: the target's bound holds from the first step on
            del values["cop_margin_x"]
    for key, value in values.items():
        if getattr(own, key) is None and getattr(target, key) is not None:
            table[key] = value
    return GaitSpecification.from_dict(table)


def blend(origin: GaitSpecification, target: GaitSpecification, fraction: float) -> GaitSpecification:
    """A specification between two; degrees, seed and bounds that only one of them has are the target's."""
    start, end = origin.as_dict(), target.as_dict()
    table: dict[str, Any] = {}
    for key, value in end.items():
        if key in ("degree", "fri_degree", "seed") or key not in start:
            table[key] = value
        else:
            mixed = (1.0 - fraction) * np.asarray(start[key]) + fraction * np.asarray(value)
            table[key] = mixed.tolist()
    return GaitSpecification.from_dict(table)


def _jumped(biped: FrontalBiped, specification: GaitSpecification, before: Gait, after: Gait) -> bool:
    problem = DesignProblem(biped, specification, OPTIMISER_NODES)
    change = (problem.variables(after) - problem.variables(before)) / problem.scale()
    return bool(np.max(np.abs(change)) > JUMP)
