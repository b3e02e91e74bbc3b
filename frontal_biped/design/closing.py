"""From variables to a gait: complete the invariance, close the orbit to rounding, integrate it until it converges."""

from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import Evaluation
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.variables import STEP_WIDTH
from frontal_biped.gait.gait import Gait, Quadrature, RobotReference, converged_quadrature, orbit_numbers
from frontal_biped.gait.robot_path import named_description
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit

CHORD_STEPS = 8
"""Most steps on the equalities; from about 1e-8, one or two reach rounding."""

CLOSED = 1e-14
"""Scaled defect at which they stop: rounding."""

STALLED = 0.5
"""Share of the defect that a step must not leave: what is left is rounding."""

AT_BOUND = 1e-9
"""Scaled distance at which a variable is on its bound: an optimiser leaves it there but for rounding."""

MOVED = 1e-5
"""Scaled way of the variables up to which the quadrature is as good as it was."""


class ClosedStep(NamedTuple):
    """A step on the converged quadrature.

    Attributes:
        x: (P,) variables.
        phases: rising and falling phase.
        step: the step through the planned reversal.
        quadrature: its nodes, and what they are worth, measured at these variables or no farther away than `MOVED`.
    """

    x: FloatArray
    phases: tuple[Phase, Phase]
    step: StepOrbit
    quadrature: Quadrature

    def gait(self, problem: DesignProblem) -> Gait:
        """The step as a gait of the problem's robot and specification, without provenance."""
        biped = problem.biped
        reference = RobotReference(biped.name, named_description(biped.path), biped.fingerprint)
        orbit = orbit_numbers(biped, self.step)
        return Gait(reference, *self.phases, float(self.x[STEP_WIDTH]), orbit, problem.specification)


def close_step(problem: DesignProblem, x: FloatArray, newton: bool = True) -> ClosedStep:
    """The step at x on as many quadrature nodes as it needs.

    Args:
        problem: the problem.
        x: (P,) variables.
        newton: take the equalities, periodicity among them, to rounding first.

    Returns:
        The step; with ``newton`` at variables that differ from x by what the equalities were off.

    Raises:
        UnreachablePoseError: the final pose does not exist.
        ReversalError: a phase has no range of beta.
    """
    biped = problem.biped
    phases = problem.phases(x)
    quadrature = converged_quadrature(biped, *phases, float(x[STEP_WIDTH]))
    if newton:
        before, x = x, meet_equalities(problem, x, quadrature.nodes)
        phases = problem.phases(x)
        if np.max(np.abs(x - before) / problem.scale()) > MOVED:
            quadrature = converged_quadrature(biped, *phases, float(x[STEP_WIDTH]))
    step = step_orbit(biped, *phases, float(x[STEP_WIDTH]), quadrature.nodes)
    return ClosedStep(x, phases, step, quadrature)


class BoundedProblem(Protocol):
    """What steps on the equalities of a design want of it."""

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds (P,)."""

    def scale(self) -> FloatArray:
        """(P,) changes of the variables that matter alike."""

    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints at x (P,)."""

    def equality(self, x: FloatArray, nodes: int) -> FloatArray:
        """(e,) the equalities of `evaluate` at x (P,) on other quadrature nodes, without derivatives."""


def meet_equalities(problem: BoundedProblem, x: FloatArray, nodes: int) -> FloatArray:
    """The point next to x (P,) where the equalities hold on so many quadrature nodes a phase, but for rounding.

    By Newton steps of least length with the slopes at x on the optimiser's own nodes: they are as good as those on
    finer ones, and next to the answer as those at any other point. A variable that is on its bound but for rounding is
    put there.
    """
    low, high = problem.bounds()
    near = AT_BOUND * problem.scale()
    x = np.where(x - low < near, low, np.where(high - x < near, high, x))
    slopes, left = None, np.inf
    for _ in range(CHORD_STEPS):
        defect = problem.equality(x, nodes)
        before, left = left, float(np.max(np.abs(defect)))
        if left < CLOSED or left > STALLED * before:
            break
        if slopes is None:
            # variables on or next to their bounds stay where they are
            room = np.minimum(x - low, high - x)
            scale = np.where(room > 1e-6 * problem.scale(), problem.scale(), 0.0)
            slopes = problem.evaluate(x).equality_jacobian * scale
        x = np.clip(x - scale * np.linalg.lstsq(slopes, defect, rcond=None)[0], low, high)
    return x
