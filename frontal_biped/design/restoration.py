"""A start where the formulas of a design have no value, brought back to where they have one."""

from typing import Protocol

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import Evaluation
from frontal_biped.design.local_model import largest_violation
from frontal_biped.exceptions import UnreachablePoseError

WORKABLE = 30.0
"""Scaled violation up to which linearised constraints lead anywhere: thirty times a typical size."""

RESTORATIONS = 12
"""Halvings of the way to the default start."""


class StartedProblem(Protocol):
    """What restoring a start wants of a problem."""

    def start(self) -> FloatArray:
        """Default start (P,)."""

    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints at x (P,)."""


def restored(problem: StartedProblem, x: FloatArray) -> FloatArray:
    """The point x (P,) itself, or where the formulas have no value there, one on the way to the default start.

    I_P next to zero, a knee of the polynomials beyond reach: half-way back, until the values are of a size that
    an optimiser can work with.
    """
    start = problem.start()
    for _ in range(RESTORATIONS):
        try:
            point = problem.evaluate(x)
            if np.isfinite(point.cost) and largest_violation(point) < WORKABLE:
                return x
        except UnreachablePoseError:
            pass
        x = 0.5 * (x + start)
    return start
