"""Gait design beside its peers, in one run on one thread: CasADi + IPOPT, SciPy's solvers, finite differences.

    OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_design.py [--quick] [--repeat N] [--json FILE]

Needs ``pip install 'frontal-biped[bench]'``. Both public specifications (the default one, and a pelvis level to 5
degrees) are designed for from the package's default start by

- `optimise_gait`, after import: optimiser, dense check and simulated step; and by its optimiser alone;
- the same problem in CasADi with IPOPT and exact Hessians (`peer_casadi_ipopt`): everything, and IPOPT alone with its
  derivative graphs already built;
- SciPy SLSQP and trust-constr, and IPOPT without second derivatives, on the package's own problem (`solvers`).

All times are CPU times. Quote the ratios; the absolute times belong to the machine. A solver reached the optimum if
its answer, evaluated by the package, violates no scaled constraint by more than 1e-6 and costs at most 0.1 % more than
the best such answer. The whole run takes about six minutes, ``--quick`` 20 s.
"""

import argparse
import itertools
import os
import platform
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from peer_casadi_ipopt import Peer, PeerResult
from solvers import (
    FEASIBLE,
    ScaledProblem,
    SolverRow,
    ipopt,
    package_sqp,
    slsqp,
    slsqp_differences,
    trust_constr,
)

import frontal_biped as fb
from frontal_biped.design import optimise_gait
from frontal_biped.design.optimise import OPTIMISER_NODES, DesignResult
from frontal_biped.files.atomic import require_parent, write_json
from frontal_biped.files.provenance import software_versions
from frontal_biped.model.biped import FrontalBiped

SPECIFICATIONS = {
    "reference": fb.GaitSpecification(),
    "level pelvis": fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0))),
}
LIMIT, QUICK_LIMIT = 60.0, 5.0
"""CPU seconds a solver gets."""


def median_seconds(task: Callable[[], object], repeat: int) -> float:
    """Median CPU time of a task."""
    times = []
    for _ in range(repeat):
        began = time.process_time()
        task()
        times.append(time.process_time() - began)
    return statistics.median(times)


def evaluations(scaled: ScaledProblem, repeat: int) -> dict[str, float]:
    """One evaluation with and without derivatives [ms]; both routes must agree."""
    problem, x = scaled.problem, scaled.start
    exact, plain = problem.evaluate(x), scaled.values_at(x)
    difference = max(abs(exact.cost - plain.cost), float(np.max(np.abs(exact.margins - plain.margins))))
    if difference > 1e-8:
        raise SystemExit(f"the values with and without derivatives differ by {difference:.3g}")
    # a problem does nothing where it is already
    points = itertools.cycle((x + 1e-3 * problem.scale(), x))
    with_derivatives = median_seconds(lambda: problem.evaluate(next(points)), repeat)
    alone = median_seconds(lambda: scaled.values_at(x), repeat)
    found = {"values and all derivatives, ms": 1e3 * with_derivatives, "values alone, ms": 1e3 * alone}
    found["forward differences / exact"] = alone * (problem.size + 1) / with_derivatives
    sizes = f"{problem.size} variables, {OPTIMISER_NODES} nodes a phase, {scaled.inequalities} inequalities"
    print(f"\nOne evaluation: {sizes}")
    for name, value in found.items():
        print(f"  {name:34}{value:9.2f}")
    return found


def designs(robot: FrontalBiped, specification: fb.GaitSpecification, repeat: int) -> dict[str, float]:
    """`optimise_gait` after import."""
    results: list[DesignResult] = [optimise_gait(robot, specification)]
    seconds = median_seconds(lambda: results.append(optimise_gait(robot, specification)), repeat)
    gait = results[-1].gait
    if gait is None:
        raise SystemExit(f"no gait: {results[-1].message}")
    return {"seconds": seconds, "J": gait.orbit.cost, "iterations": results[-1].iterations}


def peers(robot: FrontalBiped, specification: fb.GaitSpecification, barrier: str, repeat: int) -> dict[str, float]:
    """CasADi + IPOPT: everything, and IPOPT alone with the graphs already built."""
    made: list[tuple[Peer, PeerResult]] = []

    def everything() -> None:
        peer = Peer(robot, specification, barrier=barrier)
        made.append((peer, peer.solve()))

    total = median_seconds(everything, 1)
    peer, result = made[0]
    alone = median_seconds(peer.solve, repeat)
    view = peer.package_view(result.x)
    if not result.success or view["violation"] > 1e-5 or abs(view["cost"] / result.cost - 1.0) > 1e-6:
        raise SystemExit(f"the peer failed: {result.status}, J = {result.cost:.6g}, seen by the package {view}")
    return {"seconds": total, "solve seconds": alone, "J": result.cost, "iterations": result.iterations}


def print_designs(rows: dict[str, dict[str, float]]) -> None:
    """Designs beside the package's own: ratios of CPU times."""
    ours = rows["optimise_gait"]["seconds"]
    print(f"  {'':38}{'CPU s':>8}{'/ optimise_gait':>15}{'iterations':>12}{'J':>11}")
    for name, row in rows.items():
        print(f"  {name:38}{row['seconds']:8.3f}{row['seconds'] / ours:15.2f}{row['iterations']:12.0f}{row['J']:11.4f}")


def print_solvers(rows: list[SolverRow], best: float) -> None:
    """Solvers on the package's problem: ratios to its own optimiser."""
    ours = rows[0].seconds
    columns = f"{'CPU s':>8}{'/ package':>15}{'iterations':>12}{'J':>11}{'evaluations':>13}{'violation':>11}"
    print(f"  {'':38}{columns}  optimum")
    for row in rows:
        reached = "reached" if row.reached(best) else f"NOT reached: {row.message}"
        print(
            f"  {row.name:38}{row.seconds:8.3f}{row.seconds / ours:15.2f}{row.iterations:12}{row.cost:11.4f}"
            f"{row.evaluations:13}{row.violation:11.1e}  {reached}"
        )


def compare(
    robot: FrontalBiped, name: str, specification: fb.GaitSpecification, repeat: int, quick: bool
) -> dict[str, Any]:
    """Everything on one specification."""
    print(f"\n{name}: whole designs, median of {repeat}", flush=True)
    rows = {"optimise_gait": designs(robot, specification, repeat)}
    for barrier in ("adaptive",) if quick else ("adaptive", "monotone"):
        peer = peers(robot, specification, barrier, min(repeat, 3))
        rows[f"CasADi + IPOPT, {barrier} barrier"] = peer
        rows[f"IPOPT alone, graphs built, {barrier}"] = {**peer, "seconds": peer["solve seconds"]}
    print_designs(rows)

    scaled = ScaledProblem(robot, specification, QUICK_LIMIT if quick else LIMIT)
    ours = [scaled.run("package's trust-region SQP", package_sqp) for _ in range(1 if quick else 3)]
    found = [sorted(ours, key=lambda row: row.seconds)[len(ours) // 2], scaled.run("SLSQP, exact gradients", slsqp)]
    if not quick:
        found += [
            scaled.run("SLSQP, finite differences", slsqp_differences),
            scaled.run("IPOPT, limited memory, exact gradients", ipopt),
            scaled.run("trust-constr, exact gradients", trust_constr),
        ]
    best = min([row.cost for row in found if row.violation <= FEASIBLE], default=float("nan"))
    print(f"{name}: solvers on the package's problem, at most {scaled.limit:.0f} s each")
    print_solvers(found, best)
    solvers = {row.name: {**row._asdict(), "reached": row.reached(best)} for row in found}
    return {"designs": rows, "solvers": solvers}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=10, metavar="N", help="designs that a median is taken of")
    parser.add_argument("--quick", action="store_true", help="a reduced set, for continuous integration")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures to a file as well")
    arguments = parser.parse_args()
    if os.environ.get("OMP_NUM_THREADS") != "1":
        parser.error("CPU times compare on one thread only; run it with OMP_NUM_THREADS=1 in the environment")
    if arguments.json is not None:
        require_parent(arguments.json)
    repeat = 3 if arguments.quick else max(1, arguments.repeat)
    robot = fb.load_robot()
    print(f"{robot.name}, {platform.machine()}, Python {platform.python_version()}, versions {software_versions()}")
    figures: dict[str, Any] = {
        "versions": software_versions(),
        "evaluation": evaluations(ScaledProblem(robot, fb.GaitSpecification(), LIMIT), 10 * repeat),
    }
    with np.errstate(all="ignore"):  # iterates outside the domain are told by their values
        for name, specification in SPECIFICATIONS.items():
            figures[name] = compare(robot, name, specification, repeat, arguments.quick)
    if arguments.json is not None:
        write_json(arguments.json, figures)
        print(f"\nwritten to {arguments.json}", file=sys.stderr)


if __name__ == "__main__":
    main()
