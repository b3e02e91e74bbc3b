"""Design a gait: optimise, check on a dense grid, tighten where the grid disagrees, polish, certify."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.report import ConstraintReport, check_constraints
from frontal_biped.design.specification import GaitSpecification, default_specification
from frontal_biped.design.trust_region_sqp import SqpResult, SqpSettings, minimise
from frontal_biped.exceptions import ReversalError, SpecificationError, UnreachablePoseError
from frontal_biped.gait import Gait, RobotReference, converged_nodes, orbit_numbers
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.poincare import step_orbit
from frontal_biped.provenance import software_versions
from frontal_biped.virtual_constraints.invariance import complete

OPTIMISER_NODES = 16
"""Quadrature nodes a phase in the optimiser: about 1e-7 in J; the result is integrated again until 1e-11."""

TIGHTENING_ROUNDS = 4
NEWTON_STEPS = 6  # on the periodicity equation; quadratic, from about 1e-8
CLOSED = 1e-14  # scaled periodicity defect at which they stop: rounding
SAFETY = 1e-7  # every scaled constraint keeps this distance in the optimiser, against its own tolerance
RESIDUAL_TOLERANCE = 1e-9

Progress = Callable[[int, float, float], None]


@dataclass(frozen=True)
class DesignResult:
    """Outcome of a design.

    Attributes:
        gait: the gait, or None when the specification could not be met.
        report: C01 to C09 on the dense grid at the point where the optimiser stopped; None where no step exists.
        success: gait found, every constraint satisfied on the grid, every residual below 1e-9.
        message: one line: what was reached, or which constraints are in the way and what to relax.
        iterations: of the optimiser, all rounds.
        evaluations: of objective and constraints, all rounds.
        seconds: wall time.
    """

    gait: Gait | None
    report: ConstraintReport | None
    success: bool
    message: str
    iterations: int
    evaluations: int
    seconds: float


# iterates without an orbit have roots of negative numbers; they are told by their values, not by warnings
@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def design_gait(
    biped: FrontalBiped,
    specification: GaitSpecification | None = None,
    *,
    start: FloatArray | None = None,
    on_progress: Progress | None = None,
) -> DesignResult:
    """Minimise J under C01 to C09.

    Args:
        biped: the robot.
        specification: the bounds; default: `default_specification`, what the robot's description asks for.
        start: (P,) variables of `DesignProblem` to start from; default: its own start.
        on_progress: called with iteration, J [N^2 m s] and largest scaled violation.

    Returns:
        The gait and its report, or why there is none.

    Raises:
        UnreachablePoseError: no double support pose exists at the start.
        SpecificationError: the FRI margin leaves no room in the robot's sole.
    """
    spec = default_specification(biped) if specification is None else specification
    outer, inner = biped.sole
    if 2.0 * spec.fri_margin >= inner - outer:
        raise SpecificationError(
            f"fri_margin = {spec.fri_margin:g} m leaves no room in a sole of {inner - outer:g} m; reduce it"
        )
    began = time.perf_counter()
    problem = DesignProblem(biped, spec, OPTIMISER_NODES, SAFETY)
    low, high = problem.bounds()
    x = problem.start() if start is None else np.asarray(start, dtype=float)
    iterations = evaluations = 0
    for _ in range(TIGHTENING_ROUNDS):
        done = iterations

        def report_progress(count: int, cost: float, violation: float, done: int = done) -> None:
            if on_progress is not None:
                on_progress(done + count, cost, violation)

        result = minimise(problem.evaluate, x, low, high, problem.scale(), SqpSettings(), report_progress)
        iterations, evaluations = iterations + result.iterations, evaluations + result.evaluations
        x = result.x
        try:
            rising, falling = complete(biped, problem.unpack(x))
            nodes = converged_nodes(biped, rising, falling, float(x[2]))
        except (ReversalError, UnreachablePoseError) as error:
            message = f"no step exists where the optimiser stopped: {error}; relax the specification"
            return DesignResult(None, None, False, message, iterations, evaluations, time.perf_counter() - began)
        if result.feasible:
            x = _close_orbit(DesignProblem(biped, spec, nodes), x)
            rising, falling = complete(biped, problem.unpack(x))
        step = step_orbit(biped, rising, falling, float(x[2]), nodes)
        report = check_constraints(biped, spec, rising, falling, step)
        if report.satisfied or not result.feasible:
            break
        problem.tighten({(check.code, check.name): -check.margin / check.scale for check in report.violated})

    def conclude(gait: Gait | None, message: str) -> DesignResult:
        seconds = time.perf_counter() - began
        return DesignResult(gait, report, gait is not None, message, iterations, evaluations, seconds)

    if not result.feasible or not report.satisfied:
        return conclude(None, _explain(report, result))
    reference = RobotReference(biped.name, biped.path.name, biped.fingerprint)
    gait = Gait(reference, rising, falling, float(x[2]), orbit_numbers(biped, step), spec.as_dict())
    residuals = gait.residuals(biped, step)
    name = max(residuals, key=lambda key: residuals[key])
    if residuals[name] > RESIDUAL_TOLERANCE:
        bound = f"{residuals[name]:.2g}, above {RESIDUAL_TOLERANCE:g}"
        return conclude(None, f"the gait's residual {name} is {bound}; try another degree")
    provenance: dict[str, Any] = {
        "versions": software_versions(),
        "seed": spec.seed,
        "solver": {"status": result.message, "iterations": iterations, "evaluations": evaluations},
        "residuals": residuals,
    }
    orbit = gait.orbit
    message = f"J = {orbit.cost:.4f} N^2 m s, multiplier {orbit.multiplier:.4f}, all constraints satisfied"
    return conclude(replace(gait, provenance=provenance), message)


def _close_orbit(problem: DesignProblem, x: FloatArray) -> FloatArray:
    """Newton steps of least length on the periodicity equation of a problem on nodes enough for full accuracy."""
    low, high = problem.bounds()
    for _ in range(NEWTON_STEPS):
        point = problem.evaluate(x)
        if abs(point.equality[0]) < CLOSED:
            break
        # variables on or next to their bounds stay where they are
        room = np.minimum(x - low, high - x)
        scale = np.where(room > 1e-6 * problem.scale(), problem.scale(), 0.0)
        row = point.equality_jacobian[0] * scale
        x = np.clip(x - scale * row * (point.equality[0] / (row @ row)), low, high)
    return x


def _explain(report: ConstraintReport, result: SqpResult) -> str:
    if not report.violated:
        violation = f"{result.message}, violation {result.violation:.2g}"
        return f"no periodic orbit found: {violation}; widen step_duration or step_width"
    worst = [
        f"{check.code} {check.name}: {check.value:.4g} {check.unit}, bound {check.bound:.4g}"
        for check in report.violated[:4]
    ]
    more = f" and {len(report.violated) - 4} more" if len(report.violated) > 4 else ""
    return f"the specification could not be met, nearest point violates {'; '.join(worst)}{more}; relax one of these"
