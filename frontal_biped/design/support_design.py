"""Design a gait with a finite double support: the cheapest curve from the family to a reversal, walked up and down.

Variables are the curve (beta_0 at lift-off, beta_r-, Bezier columns 2..M, FRI coefficients) and the time in which the
robot sets off from rest. Column 0 lies on the double-support family, column 1 gives its slope. There is no equality: a
step that retraces itself closes (see `gait.support_gait`), and the speed of the orbit follows from the reversal. Few
variables and few nodes: derivatives are forward differences.
"""

from dataclasses import dataclass, replace

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.evaluation import Evaluation
from frontal_biped.design.problem import COLUMN_REACH
from frontal_biped.design.trust_region_sqp import SqpSettings, minimise
from frontal_biped.exceptions import DesignFailedError, ReversalError, UnreachablePoseError
from frontal_biped.files.provenance import software_versions
from frontal_biped.gait.gait import RobotReference
from frontal_biped.gait.robot_path import named_description
from frontal_biped.gait.specification import default_specification
from frontal_biped.gait.support_constraints import evaluate_support_step, margins
from frontal_biped.gait.support_gait import SupportGait, SupportNumbers, SupportSpecification
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.catalogue import RobotLike, biped_of
from frontal_biped.virtual_constraints.double_support import DoubleSupportFamily
from frontal_biped.virtual_constraints.phase import Phase

NODES = 14, 28
"""Quadrature nodes of the rising half in the optimiser; the finer ones where the coarse ones miss a violation."""

DENSE = 60
"""Nodes on which the answer is checked."""

SAFETY = 1e-2
"""Scaled distance that every constraint keeps in the optimiser: more than what it misses between the nodes."""

DIFFERENCE = 1e-6
"""Forward difference, in units of the variables' scales."""

HIP_WIDTHS = 1.2
"""Default distance between the ankles, within the bounds."""

STARTS = (0.03, 0.06), (0.03, 0.04), (0.04, 0.03), (0.02, 0.08)
"""Starts, tried until one leads to a gait: beta at lift-off beyond half-way, range of beta [rad]."""

SET_OFF = 0.8
"""Duration of setting off at the start [s]."""

NOWHERE = 1e6
"""Scaled violation where a step cannot be evaluated."""


@dataclass(frozen=True)
class SupportDesign:
    """What a design found.

    Attributes:
        gait: the gait.
        cost: J of a step, double support included [N^2 m s].
        duration: of a step [s].
        double_support: of that [s].
        margin: the least scaled margin of all constraints on dense nodes.
        iterations: of the optimiser.
    """

    gait: SupportGait
    cost: float
    duration: float
    double_support: float
    margin: float
    iterations: int


class _Problem:
    """The design as `trust_region_sqp.minimise` asks for it."""

    def __init__(self, biped: FrontalBiped, asked: SupportSpecification, width: float) -> None:
        self.biped, self.asked, self.nodes = biped, asked, NODES[0]
        self.family = DoubleSupportFamily(biped, width)
        self._robot = RobotReference(biped.name, named_description(biped.path), biped.fingerprint)
        self._degree, self._fri_degree = max(asked.bounds.degrees), asked.bounds.fri_degree
        self._fri = slice(3 + 3 * (self._degree - 1), None)
        self._size = 0

    def start(self, lean: float, rise: float) -> FloatArray:
        """A sway on the family's tangent while the pelvis lifts the swing foot by twice the clearance."""
        M, beta = self._degree, self.family.half_way() + lean
        at = self.family.at(beta)
        roll = 2.0 * self.asked.bounds.swing_clearance / self.biped.hip_width
        s = np.linspace(0.0, 1.0, M + 1)
        lifted = np.outer([1.0, -1.0, 0.0], roll * s**2 * (3.0 - 2.0 * s))
        columns = at.q[1:, None] + np.outer(at.dq[1:], rise * s) + lifted
        middle = np.full(self._fri_degree + 1, 0.5 * sum(self.biped.sole))
        return np.concatenate([[beta, beta + rise, SET_OFF], columns[:, 2:].T.ravel(), middle])

    def scale(self) -> FloatArray:
        """Changes of the variables that matter alike."""
        scale = np.full(self._fri.start + self._fri_degree + 1, 0.1)
        scale[:3] = 0.02, 0.02, 0.2
        scale[self._fri] = 0.02
        return scale

    def bounds(self, start: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Box of the variables."""
        low, high = start - COLUMN_REACH, start + COLUMN_REACH
        half_way = self.family.half_way()
        outer, inner = self.biped.sole
        low[:3] = half_way + 2e-3, half_way + 4e-3, 0.2
        high[:3] = half_way + 0.15, half_way + 0.4, 3.0
        low[self._fri], high[self._fri] = 2.0 * outer - inner, 2.0 * inner - outer
        return low, high

    def use(self, nodes: int) -> None:
        """So many quadrature nodes from now on."""
        self.nodes, self._size = nodes, 0

    def gait(self, x: FloatArray) -> SupportGait:
        """The gait of the variables; its speed is that of the orbit where there is one."""
        start, end, setting_off = x[:3].tolist()
        at, M = self.family.at(start), self._degree
        first = at.q[1:]
        columns = x[3 : self._fri.start].reshape(-1, 3).T
        joints = np.column_stack([first, first + at.dq[1:] * (end - start) / M, columns])
        rising = Phase(start, end, joints, x[self._fri].copy())
        return SupportGait(self._robot, rising, self.family.width, 0.0, setting_off, self.asked)

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray] | None:
        """Residuals of J and scaled margins; None where there is no step."""
        try:
            with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
                step = evaluate_support_step(self.biped, self.gait(x), self.nodes)
        except (ReversalError, UnreachablePoseError):
            return None
        kept = margins(step.constraints, SAFETY)
        if not (np.isfinite(step.residuals).all() and np.isfinite(kept).all()):
            return None
        return step.residuals, kept

    def evaluate(self, x: FloatArray) -> Evaluation:
        """Objective and constraints with forward differences; far from feasible where there is no step."""
        at, scale = self.values(x), self.scale()
        n = len(x)
        if at is None:
            none = np.zeros((1, n))
            empty = np.empty(0), np.empty((0, n))
            nowhere = np.full(self._size or 1, -NOWHERE)
            return Evaluation(np.inf, np.zeros(n), none, *empty, nowhere, np.zeros((len(nowhere), n)))
        residuals, kept = at
        self._size = len(kept)
        R, C = np.zeros((len(residuals), n)), np.zeros((len(kept), n))
        for i in range(n):
            for h in (DIFFERENCE * scale[i], -DIFFERENCE * scale[i]):
                moved = x.copy()
                moved[i] += h
                beside = self.values(moved)
                if beside is not None:
                    R[:, i], C[:, i] = (beside[0] - residuals) / h, (beside[1] - kept) / h
                    break
        gradient = 2.0 * residuals @ R
        cost = float(residuals @ residuals)
        return Evaluation(cost, gradient, R, np.empty(0), np.empty((0, n)), kept, C)


def design_support_gait(
    robot: RobotLike, asked: SupportSpecification | None = None, width: float | None = None
) -> SupportDesign:
    """The cheapest gait with a finite double support that can be entered from standing.

    Args:
        robot: the robot, in any of its views, or by name or path.
        asked: the bounds; default: the robot's own for a gait, and double supports of 0.1 to 0.2 s.
        width: distance between the ankles [m]; default: 1.2 hip widths, within the bounds.

    Returns:
        The gait and its figures.

    Raises:
        DesignFailedError: none was found.
        UnreachablePoseError: the feet cannot stand so far apart.
    """
    biped = biped_of(robot)
    asked = SupportSpecification(default_specification(biped)) if asked is None else asked
    width = float(np.clip(HIP_WIDTHS * biped.hip_width, *asked.bounds.step_width)) if width is None else width
    problem = _Problem(biped, asked, width)
    iterations = 0
    for start in STARTS:
        x = problem.start(*start)
        box = problem.bounds(x)
        for nodes in NODES:
            problem.use(nodes)
            found = minimise(problem.evaluate, x, *box, problem.scale(), SqpSettings())
            iterations += found.iterations
            if not found.feasible:
                break
            x, gait = found.x, problem.gait(found.x)
            step = evaluate_support_step(biped, gait, DENSE)
            least = float(margins(step.constraints).min())
            if least >= 0.0:
                numbers = SupportNumbers(step.duration, step.hand_over.duration, step.cost)
                speed = float(step.orbit.dbeta[-1])
                made = {"versions": software_versions(), "iterations": iterations, "nodes": nodes, "margin": least}
                gait = replace(gait, speed=speed, numbers=numbers, provenance=made)
                return SupportDesign(gait, step.cost, step.duration, step.hand_over.duration, least, iterations)
    short, long = asked.double_support
    raise DesignFailedError(
        f"{biped.name}: no gait found with a double support of {short:g} to {long:g} s, ankles {width:.3g} m apart:"
        f" violation {found.violation:.2g} ({found.message}); change double_support, width or the bounds"
    )
