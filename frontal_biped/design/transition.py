"""Change from one gait to another in a single step, without leaving the zero dynamics.

A transition step begins with the pose, slope and speed in which one gait has landed and ends with the pose, slope and
speed in which another one lands. Pose and slope are built in, as hybrid invariance is in a gait; two equalities match
the speeds. The tracking error is zero at both switches, so a library of gaits can be walked from one to the other.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.design.ends import Between
from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.search import Search
from frontal_biped.design.variables import STEP_WIDTH
from frontal_biped.exceptions import DesignFailedError, GaitFileError
from frontal_biped.gait.check import ConstraintReport
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import Phase


@dataclass(frozen=True)
class Transition:
    """One step from a gait to another; no periodic gait, but a `PlannedStep` that a controller can track.

    Attributes:
        rising: virtual constraints from the first gait's impact to the reversal.
        falling: virtual constraints from the reversal to the impact.
        step_width: distance between the ankles where it ends [m].
        duration: [s].
        cost: J [N^2 m s].
        speed_after_impact: dbeta_r+, with which it begins [rad/s].
        speed_before_impact: dbeta_f-, with which it ends [rad/s].
        speed_error: relative error of the latter, against the second gait's [-].
        specification: the bounds.
        report: the constraints on the dense grid.
    """

    rising: Phase
    falling: Phase
    step_width: float
    duration: float
    cost: float
    speed_after_impact: float
    speed_before_impact: float
    speed_error: float
    specification: GaitSpecification
    report: ConstraintReport


def design_transition(
    biped: FrontalBiped, before: Gait, after: Gait, specification: GaitSpecification | None = None
) -> Transition:
    """The cheapest step from one gait to another.

    Args:
        biped: the robot.
        before: the gait walked until now.
        after: the gait walked from the next impact on.
        specification: bounds of the step; default: of each bound the looser one of both gaits.

    Returns:
        The transition, checked on the dense grid.

    Raises:
        DesignFailedError: no such step keeps the bounds.
        GaitFileError: the gaits belong to different robots.
    """
    if before.robot.fingerprint != after.robot.fingerprint:
        raise GaitFileError(
            f"a transition from {before.robot.name!r} to {after.robot.name!r}: the gaits must be of one robot"
        )
    spec = _looser(before, after) if specification is None else specification
    ends = Between(biped, before, after)
    problem = DesignProblem(biped, spec, OPTIMISER_NODES, SAFETY, ends=ends)
    found = Search().cheapest(problem, problem.start())
    if found.closed is None or found.report is None or not found.result.feasible:
        why = found.obstacle or f"{found.result.message}, violation {found.result.violation:.2g}"
        raise DesignFailedError(
            f"no single step leads from one gait to the other within the bounds: {why}; take gaits nearer to each"
            " other, or relax the specification"
        )
    if not found.good:
        raise DesignFailedError(
            f"the step found violates {found.report.violated[0].name} between the optimiser's nodes; relax the"
            " specification"
        )
    (rising, falling), step = found.closed.phases, found.closed.step
    speed = float(step.falling.dbeta[-1])
    return Transition(
        rising,
        falling,
        float(found.closed.x[STEP_WIDTH]),
        float(step.duration),
        float(step.cost),
        float(step.rising.dbeta[-1]),
        speed,
        speed / ends.speed_before_impact - 1.0,
        spec,
        found.report,
    )


def _looser(before: Gait, after: Gait) -> GaitSpecification:
    """Of each bound the looser one; a bound that one of the gaits does not have is dropped."""
    first, second = (gait.specification.as_dict() for gait in (before, after))
    table = {}
    for key in first.keys() & second.keys():
        a, b = first[key], second[key]
        if key in ("step_duration", "step_width"):
            table[key] = [min(a[0], b[0]), max(a[1], b[1])]
        elif key in ("friction", "yaw_friction", "fri_degree", "seed") or (
            key.startswith("max_") and key != "max_torque"
        ):
            table[key] = max(a, b)
        elif key in ("max_torque", "degree"):
            table[key] = np.maximum(a, b).tolist()
        else:
            table[key] = min(a, b)
    return GaitSpecification.from_dict(table)
