"""Gait design: exact derivatives against finite differences of the same code, and whole designs, in one run.

    python tests/benchmarks/benchmark_design.py [--repeat N]

Quote the ratios; the absolute times belong to the machine.
"""

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import frontal_biped as fb
from frontal_biped.design.optimise import OPTIMISER_NODES
from frontal_biped.design.problem import DesignProblem


def median_seconds(task: Callable[[], object], repeat: int) -> float:
    """Median wall time of a task."""
    times = []
    for _ in range(repeat):
        began = time.perf_counter()
        task()
        times.append(time.perf_counter() - began)
    return statistics.median(times)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=10)
    repeat = parser.parse_args().repeat
    robot = fb.load_robot()
    problem = DesignProblem(robot, fb.GaitSpecification(), OPTIMISER_NODES)
    x = problem.start()

    exact = median_seconds(lambda: problem.evaluate(x), 10 * repeat)

    def values() -> None:
        """Objective and constraints without derivatives: what one finite difference costs."""
        from frontal_biped.design.report import dense_constraints
        from frontal_biped.poincare import step_orbit
        from frontal_biped.virtual_constraints import complete

        rising, falling = complete(robot, problem.unpack(x))
        step = step_orbit(robot, rising, falling, float(x[2]), OPTIMISER_NODES)
        dense_constraints(robot, fb.GaitSpecification(), rising, falling, step, OPTIMISER_NODES)

    plain = median_seconds(values, 10 * repeat)
    print(f"{problem.size} variables, {OPTIMISER_NODES} nodes a phase")
    print(f"values alone                     {1e3 * plain:8.2f} ms")
    print(f"values and all derivatives       {1e3 * exact:8.2f} ms")
    print(f"forward differences / exact      {plain * (problem.size + 1) / exact:8.1f}")

    for name, specification in (
        ("reference", fb.GaitSpecification()),
        ("level pelvis", fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0)))),
    ):
        results = [fb.design_gait(robot, specification) for _ in range(repeat)]
        seconds = statistics.median(result.seconds for result in results)
        last = results[-1]
        assert last.gait is not None
        print(
            f"design, {name:14}           {seconds:8.3f} s, J = {last.gait.orbit.cost:.4f},"
            f" {last.iterations} iterations, {last.evaluations} evaluations,"
            f" {last.evaluations * exact / seconds:.0%} of it in evaluations"
        )


if __name__ == "__main__":
    main()
