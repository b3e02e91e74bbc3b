"""How often a design succeeds: random starts of two specifications, and random specifications.

    OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_starts.py [--starts N] [--specifications N] [--seed S]
                                                                  [--peer] [--json FILE]

Starts: the default one with every free Bezier coefficient of the joints moved by up to 0.1 rad, beta_r- by up to
0.03 rad and the step width anywhere in its bounds, uniformly. Each is restored (`restored`) and optimised
(`minimise`) once; and, for comparison, optimised without restoration. Its answer counts as a gait if the optimiser
calls it feasible and 40 quadrature nodes a phase, not the optimiser's 16, confirm a stable periodic orbit; violations
between the optimiser's nodes, which `optimise_gait` removes by tightening, are listed.

Specifications: friction, step duration, step width, pelvis roll, clearance and degrees at random, through
`optimise_gait`. Each must end in a verified gait or in an explanation whose remedy leaves a gait: the remedy is
followed here, by a design of the relaxed specification. One that ends otherwise is printed in full. With ``--peer``
CasADi and IPOPT (`peer_casadi_ipopt`, needs the extra ``bench``) try every specification as well, from the same start
and with the highest of its degrees: where they find a gait, it was not the specification that could not be met.

Times are CPU times. 100 starts and 20 specifications take about five minutes of them, ``--peer`` two more.
"""

import argparse
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import frontal_biped as fb
from frontal_biped.arrays import FloatArray
from frontal_biped.design import optimise_gait
from frontal_biped.design.optimise import OPTIMISER_NODES, SAFETY
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.restoration import restored
from frontal_biped.design.trust_region_sqp import SqpSettings, minimise
from frontal_biped.exceptions import FrontalBipedError, UnreachablePoseError
from frontal_biped.files.atomic import require_parent, write_json
from frontal_biped.gait.check import check_constraints
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints import complete
from frontal_biped.zero_dynamics.poincare import step_orbit

SPECIFICATIONS = {
    "reference": fb.GaitSpecification(),
    "level pelvis": fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0))),
}
COLUMN_SPREAD, REVERSAL_SPREAD = 0.1, 0.03  # rad
CONFIRMING_NODES = 40
PERIODIC = 1e-4
"""Periodicity defect [rad^2/s^2] on the confirming nodes: the error of the optimiser's 16 nodes is below it."""

SAME_COST = 1e-3  # relative excess over the best J at which an answer counts as the same optimum
QUANTILES = (0.0, 0.1, 0.5, 0.9, 1.0)


class StartOutcome(NamedTuple):
    """What became of one start.

    Attributes:
        number: of the start; with the seed it draws the start again.
        halvings: of the way to the default start, in the restoration.
        moved: largest change by the restoration, in the problem's scales.
        gait: did it end in a feasible gait?
        message: the optimiser's last word, and what the confirming nodes say against it.
        cost: J [N^2 m s].
        violation: largest scaled violation the optimiser sees.
        between: largest scaled violation on the dense grid.
        iterations: of the optimiser.
        evaluations: of the optimiser.
        seconds: CPU time, restoration included.
    """

    number: int
    halvings: float
    moved: float
    gait: bool
    message: str
    cost: float
    violation: float
    between: float
    iterations: int
    evaluations: int
    seconds: float


def random_start(problem: DesignProblem, rng: np.random.Generator) -> FloatArray:
    """(P,) a start around the default one, inside the bounds."""
    start = problem.start()
    free = problem.unpack(start)
    first, count = 3, free.rising_columns.size + free.falling_columns.size
    x = start.copy()
    x[first : first + count] += rng.uniform(-COLUMN_SPREAD, COLUMN_SPREAD, count)
    x[0] += rng.uniform(-REVERSAL_SPREAD, REVERSAL_SPREAD)
    x[2] = rng.uniform(*problem.specification.step_width)
    return np.clip(x, *problem.bounds())


def run_start(
    robot: FrontalBiped, specification: fb.GaitSpecification, seed: int, number: int, restore: bool = True
) -> StartOutcome:
    """Restore, unless told not to, optimise and confirm one start."""
    problem = DesignProblem(robot, specification, OPTIMISER_NODES, SAFETY)
    low, high = problem.bounds()
    drawn = random_start(problem, np.random.default_rng([seed, number]))
    began = time.process_time()
    x = restored(problem, drawn) if restore else drawn
    try:
        result = minimise(problem.evaluate, x, low, high, problem.scale(), SqpSettings())
    except (UnreachablePoseError, ValueError, ArithmeticError) as error:  # no values at the start, or overflow
        message = f"raised {type(error).__name__}: {error}"
        return StartOutcome(number, 0.0, 0.0, False, message, *[float("nan")] * 3, 0, 0, 0.0)
    seconds = time.process_time() - began
    default = problem.start()
    kept = float(np.linalg.norm(x - default) / np.linalg.norm(drawn - default))
    halvings = -np.log2(kept) if kept > 0.0 else float("inf")
    gait, message, between = result.feasible, result.message, float("nan")
    try:
        rising, falling = complete(robot, problem.unpack(result.x))
        step = step_orbit(robot, rising, falling, float(result.x[2]), CONFIRMING_NODES)
        stable = 0.0 < step.multiplier < 1.0 and min(np.min(step.rising.z), np.min(step.falling.z)) > 0.0
        if gait and not (stable and abs(step.periodicity) < PERIODIC):
            gait, message = False, f"{message}; NOT confirmed, periodicity defect {step.periodicity:.2g} rad^2/s^2"
        report = check_constraints(robot, specification, rising, falling, step)
        between = max(0.0, -min(check.margin / check.scale for check in report.checks))
    except FrontalBipedError as error:
        gait, message = False, f"{message}; {error}"
    return StartOutcome(
        number,
        halvings + 0.0,
        float(np.max(np.abs(x - drawn) / problem.scale())),
        gait,
        message,
        result.cost,
        result.violation,
        between,
        result.iterations,
        result.evaluations,
        seconds,
    )


def random_specification(rng: np.random.Generator, number: int) -> fb.GaitSpecification:
    """Bounds drawn one by one, so that some contradict each other."""
    duration, width = rng.uniform(0.25, 0.6), rng.uniform(0.12, 0.3)
    degree: int | tuple[int, int, int] = int(rng.integers(4, 9))
    if rng.random() < 0.3:
        first, second, third = (int(part) for part in rng.integers(4, 9, 3))
        degree = (first, second, third)
    return fb.GaitSpecification(
        degree=degree,
        friction=round(rng.uniform(0.15, 0.9), 3),
        swing_clearance=round(rng.uniform(0.002, 0.04), 4),
        step_duration=(round(duration, 3), round(duration + rng.uniform(0.05, 0.5), 3)),
        step_width=(round(width, 3), round(width + rng.uniform(0.02, 0.2), 3)),
        max_pelvis_roll=round(float(np.radians(rng.uniform(1.0, 15.0))), 4) if rng.random() < 0.7 else None,
        seed=number,
    )


class SpecificationOutcome(NamedTuple):
    """What became of one specification.

    Attributes:
        number: of the specification; with the seed it draws the specification again.
        kind: "verified gait", "remedy leaves a gait", or what went wrong.
        good: is it one of the first two?
        message: of `optimise_gait`.
        cost: J [N^2 m s]; nan without a gait.
        iterations: of the optimiser, explanation included.
        seconds: CPU time, the design of the relaxed specification not included.
        peer_cost: J of the peer's gait [N^2 m s]; nan where it found none or was not asked.
        specification: as a file would say it.
    """

    number: int
    kind: str
    good: bool
    message: str
    cost: float
    iterations: int
    seconds: float
    peer_cost: float
    specification: dict[str, Any]


PEER_TOLERANCE = 0.1
"""Scaled violation between its nodes up to which the peer's answer counts: the package would tighten it away."""


def peer_cost(robot: FrontalBiped, specification: fb.GaitSpecification) -> float:
    """J [N^2 m s] of the gait that the peer finds, or nan."""
    from peer_casadi_ipopt import Peer

    peer = Peer(robot, replace(specification, degree=max(specification.degrees)))
    result = peer.solve()
    if not result.success or peer.package_view(result.x)["violation"] > PEER_TOLERANCE:
        return float("nan")
    return result.cost


def run_specification(robot: FrontalBiped, seed: int, number: int, peer: bool) -> SpecificationOutcome:
    """Design for one random specification, and follow the remedy if there is one."""
    specification = random_specification(np.random.default_rng([seed, number]), number)
    began = time.process_time()
    result = optimise_gait(robot, specification)
    seconds = time.process_time() - began
    cost, good = float("nan"), True
    if result.gait is not None:
        verified = result.verification is not None and result.verification.passed
        satisfied = result.report is not None and result.report.satisfied
        good = result.success and verified and satisfied
        kind, cost = "verified gait" if good else "gait that is not verified", result.gait.orbit.cost
    elif result.remedy is not None:
        relaxed = optimise_gait(robot, result.remedy.specification)
        good = relaxed.success
        kind = "remedy leaves a gait" if good else f"remedy leaves NO gait: {relaxed.message}"
    else:
        kind, good = ("conflict without a remedy" if result.conflicts else "neither gait nor conflict"), False
    theirs = peer_cost(robot, specification) if peer else float("nan")
    return SpecificationOutcome(
        number, kind, good, result.message, cost, result.iterations, seconds, theirs, specification.as_dict()
    )


# ---------------------------------------------------------------------- tables
def quantiles(values: list[float]) -> FloatArray:
    finite = np.array([value for value in values if np.isfinite(value)])
    return np.quantile(finite, QUANTILES) if len(finite) else np.full(len(QUANTILES), np.nan)


def print_starts(name: str, outcomes: list[StartOutcome]) -> dict[str, Any]:
    """Table of one specification's starts."""
    gaits = [outcome for outcome in outcomes if outcome.gait]
    best = min((outcome.cost for outcome in gaits), default=float("nan"))
    same = sum(outcome.cost <= best * (1.0 + SAME_COST) for outcome in gaits)
    restored = sum(outcome.moved > 0.0 for outcome in outcomes)
    print(f"\n{name}: {len(gaits)} of {len(outcomes)} starts end in a feasible gait, {same} of them within 0.1 % of")
    print(f"the best J = {best:.4f} N^2 m s; {restored} starts had to be restored")
    rows = {
        "J of the gaits [N^2 m s]": [outcome.cost for outcome in gaits],
        "iterations": [float(outcome.iterations) for outcome in outcomes],
        "evaluations": [float(outcome.evaluations) for outcome in outcomes],
        "CPU time [s]": [outcome.seconds for outcome in outcomes],
        "restoration, halvings of the way": [outcome.halvings for outcome in outcomes],
        "restoration, largest move [scales]": [outcome.moved for outcome in outcomes],
        "violation between the nodes [scales]": [outcome.between for outcome in gaits],
    }
    print(f"  {'':38}" + "".join(f"{f'{100 * q:.0f} %':>11}" for q in QUANTILES))
    table = {}
    for row, values in rows.items():
        table[row] = quantiles(values).tolist()
        print(f"  {row:38}" + "".join(f"{value:11.4g}" for value in table[row]))
    failures: dict[str, list[int]] = {}
    for outcome in outcomes:
        if not outcome.gait:
            failures.setdefault(outcome.message.split(";")[0], []).append(outcome.number)
    for message, numbers in failures.items():
        print(f"  {len(numbers):3} without a gait, {message}: starts {', '.join(map(str, numbers))}")
    return {"gaits": len(gaits), "same optimum": same, "quantiles": table, "starts": [o._asdict() for o in outcomes]}


def print_specifications(outcomes: list[SpecificationOutcome]) -> None:
    """Table of the random specifications."""
    good = sum(outcome.good for outcome in outcomes)
    print(f"\n{good} of {len(outcomes)} random specifications end in a verified gait or a remedy that leaves one")
    for kind, count in Counter(outcome.kind.split(":")[0] for outcome in outcomes).items():
        print(f"  {count:3} {kind}")
    print(f"  {'':4}{'iterations':>12}{'CPU s':>8}{'J':>11}{'peer J':>11}  outcome")
    for outcome in outcomes:
        figures = f"{outcome.iterations:12}{outcome.seconds:8.2f}{outcome.cost:11.2f}{outcome.peer_cost:11.2f}"
        print(f"  {outcome.number:4}{figures}  {outcome.kind}")
        if outcome.kind != "verified gait":
            print(f"       {outcome.specification}")
            print(f"       {outcome.message}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=100, metavar="N", help="random starts a specification")
    parser.add_argument("--specifications", type=int, default=20, metavar="N", help="random specifications")
    parser.add_argument("--peer", action="store_true", help="let the peer try the random specifications as well")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="of everything random")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every outcome to a file as well")
    arguments = parser.parse_args()
    if arguments.json is not None:
        require_parent(arguments.json)
    robot, seed = fb.load_robot(), arguments.seed
    figures: dict[str, Any] = {"seed": seed}
    with np.errstate(all="ignore"):  # iterates outside the domain are told by their values
        if arguments.starts > 0:
            for restore in (True, False):
                for name, specification in SPECIFICATIONS.items():
                    title = name if restore else f"{name}, not restored"
                    starts = []
                    for number in range(arguments.starts):
                        starts.append(run_start(robot, specification, seed, number, restore))
                        found = sum(outcome.gait for outcome in starts)
                        print(f"\r{title}: {number + 1} starts, {found} gaits ", end="", flush=True)
                    figures[title] = print_starts(title, starts)
        specifications = []
        for number in range(arguments.specifications):
            specifications.append(run_specification(robot, seed, number, arguments.peer))
            print(f"\r{number + 1} specifications ", end="", flush=True)
        if specifications:
            print_specifications(specifications)
    figures["specifications"] = [outcome._asdict() for outcome in specifications]
    if arguments.json is not None:
        write_json(arguments.json, figures)


if __name__ == "__main__":
    main()
