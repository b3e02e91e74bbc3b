"""The constraints C01 to C09 on two different steps in turn: those of either step, and the stability of both together.

A step of the two may be unstable alone, so C01 bounds m_A m_B. ``max_multiplier`` is a bound a step, and is kept by the
geometric mean sqrt(m_A m_B), which is the multiplier where the steps are equal.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from frontal_biped.gait.check import DENSE_POINTS, ConstraintCheck, ConstraintReport, check_constraints, worst_point
from frontal_biped.gait.constraints import SHARE, Constraint, SoleHeights, step_constraints
from frontal_biped.gait.holding_wrench import StepHolding
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.two_steps import TwoSteps

NAMES = "A", "B"
"""Of the steps; the names of their constraints begin with them."""

MULTIPLIER = "multiplier a step, sqrt(m_A m_B)"


class TwoPhases(NamedTuple):
    """Virtual constraints of two steps in turn: rising and falling phase of step A and of step B."""

    a: tuple[Phase, Phase]
    b: tuple[Phase, Phase]


def two_step_constraints(
    biped: FrontalBiped,
    specification: GaitSpecification,
    steps: TwoSteps,
    soles: tuple[SoleHeights, SoleHeights],
    holding: tuple[StepHolding | None, StepHolding | None] = (None, None),
) -> list[Constraint]:
    """Every constraint of the specification, evaluated on both steps; see `step_constraints`.

    Args:
        biped: the robot.
        specification: the bounds.
        steps: sampled from their reversals to their impacts.
        soles: heights of the swing sole at the same points.
        holding: what the ground must hold at the same points; needed where the specification bounds it.
    """
    found = [pair_multiplier(specification, steps)]
    for name, (step, before), heights, held in zip(NAMES, steps.in_turn, soles, holding, strict=True):
        of_step = step_constraints(biped, specification, step, heights, departure=before.landing, holding=held)
        found += [constraint._replace(name=f"{name}: {constraint.name}") for constraint in of_step]
    return found


def pair_multiplier(specification: GaitSpecification, steps: TwoSteps) -> Constraint:
    """C01 of both steps together."""
    top = 1.0 if specification.max_multiplier is None else specification.max_multiplier
    mean = np.stack([np.sqrt(steps.multiplier)])
    return Constraint("C01", MULTIPLIER, "-", mean, 0.0, top, SHARE, strict=True, keys=("", "max_multiplier"))


def check_two_steps(
    biped: FrontalBiped,
    specification: GaitSpecification,
    phases: TwoPhases,
    steps: TwoSteps,
    points: int = DENSE_POINTS,
) -> ConstraintReport:
    """Evaluate every constraint of both steps on a dense grid; see `check_constraints`.

    Args:
        biped: the robot.
        specification: the bounds.
        phases: virtual constraints of both steps.
        steps: both on converged quadrature nodes.
        points: of the grid a phase, both ends included.
    """
    checks: list[ConstraintCheck] = [worst_point(pair_multiplier(specification, steps))]
    for name, own, (step, before) in zip(NAMES, phases, steps.in_turn, strict=True):
        report = check_constraints(biped, specification, *own, step, points, before.landing)
        checks += [replace(check, name=f"{name}: {check.name}") for check in report.checks]
    return ConstraintReport(tuple(checks), points)
