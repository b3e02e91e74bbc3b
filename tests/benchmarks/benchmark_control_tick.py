"""One control tick beside ProxQP's own share of it, in one run, on and off the nominal orbit.

python tests/benchmarks/benchmark_control_tick.py [--ticks N]
"""

import argparse
import time

import numpy as np

import frontal_biped as fb
from frontal_biped.control import QpController
from frontal_biped.quadratic_program import ProxQpSolver
from frontal_biped.virtual_constraints import StepPhase


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ticks", type=int, default=4000)
    ticks = parser.parse_args().ticks
    robot = fb.load_robot()
    gait = fb.design_gait(robot).gait
    assert gait is not None
    q, dq = gait.state_after_impact()
    rng = np.random.default_rng(0)

    inside: list[float] = []
    solve = ProxQpSolver.solve

    def timed(self, *arguments, **keywords):
        began = time.perf_counter()
        solution = solve(self, *arguments, **keywords)
        inside.append(time.perf_counter() - began)
        return solution

    ProxQpSolver.solve = timed
    for name, spread in (("on the orbit", 0.0), ("1 mrad off", 1e-3), ("10 mrad off", 1e-2)):
        controller = QpController(robot, gait)
        inside.clear()
        whole = []
        for _ in range(ticks):
            state = q + spread * rng.normal(size=4), dq + 5.0 * spread * rng.normal(size=4)
            began = time.perf_counter()
            controller.command(StepPhase.RISING, *state)
            whole.append(time.perf_counter() - began)
        tick, qp = (1e6 * np.percentile(times, [50, 99, 100]) for times in (whole, inside))
        print(
            f"{name:14} tick p50 {tick[0]:6.0f} p99 {tick[1]:6.0f} max {tick[2]:7.0f} us;"
            f" ProxQP p50 {qp[0]:5.0f} p99 {qp[1]:6.0f} us; ratio of medians {tick[0] / qp[0]:.1f};"
            f" unsolved {controller.unsolved} of {ticks}"
        )


if __name__ == "__main__":
    main()
