"""From variables to a gait: complete the invariance, close the orbit to rounding, integrate it until it converges."""

from typing import NamedTuple, Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import Evaluation
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.variables import STEP_WIDTH
from frontal_biped.gait.gait import Gait, RobotReference, converged_nodes, orbit_numbers
from frontal_biped.gait.robot_path import named_description
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit

NEWTON_STEPS = 6  # on the periodicity equation; quadratic, from about 1e-8
CLOSED = 1e-14  # scaled periodicity defect at which they stop: rounding


class ClosedStep(NamedTuple):
    """A step on the converged quadrature.

    Attributes:
        x: (P,) variables.
        phases: rising and falling phase.
        step: the step through the planned reversal.
    """

    x: FloatArray
    phases: tuple[Phase, Phase]
    step: StepOrbit

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
    nodes = converged_nodes(biped, *phases, float(x[STEP_WIDTH]))
    if newton:
        x = meet_equalities(problem.on_nodes(nodes), x)
        phases = problem.phases(x)
    return ClosedStep(x, phases, step_orbit(biped, *phases, float(x[STEP_WIDTH]), nodes))


class BoundedProblem(Protocol):
    """What Newton steps on the equalities of a design want of it."""

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lower and upper bounds (P,)."""

    def scale(self) -> FloatArray:
        """(P,) changes of the variables that matter alike."""

    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints at x (P,)."""


def meet_equalities(problem: BoundedProblem, x: FloatArray) -> FloatArray:
    """Newton steps of least length on the equalities."""
    low, high = problem.bounds()
    for _ in range(NEWTON_STEPS):
        point = problem.evaluate(x)
        if np.max(np.abs(point.equality)) < CLOSED:
            break
        # variables on or next to their bounds stay where they are
        room = np.minimum(x - low, high - x)
        scale = np.where(room > 1e-6 * problem.scale(), problem.scale(), 0.0)
        rows = point.equality_jacobian * scale
        x = np.clip(x - scale * np.linalg.lstsq(rows, point.equality, rcond=None)[0], low, high)
    return x
