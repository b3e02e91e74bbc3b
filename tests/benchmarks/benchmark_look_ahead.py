"""Looking ahead, looked up and computed, beside a walking tick of the controller that asks for it.

python tests/benchmarks/benchmark_look_ahead.py [--speeds N] [--computed N] [gait file ...]

Speeds after the impact are drawn over the basin of every gait. Each is looked up at the impact and at its reversal in
the table kept with the gait (tabulated here where a file has none), and some are computed as well. Times are CPU times
of the thread: a busy machine inflates them. The answers of both are compared: "the same" is the same stretch, and a
falling phase that is the same function to 1e-9.
"""

import argparse
import gc
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import numpy as np

import frontal_biped as fb
from frontal_biped.analysis.return_map import RestrictedMap
from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.control.stabilisers.look_ahead import LookAheadTransitions
from frontal_biped.control.stabilisers.tabulation import tabulated
from frontal_biped.design import optimise_gait
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model import FrontalBiped
from frontal_biped.virtual_constraints import StepPhase
from frontal_biped.zero_dynamics.half_steps import rising_energy

SAME = 1e-9
"""[rad]"""

Answer = TypeVar("Answer")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--speeds", type=int, default=1000)
    parser.add_argument("--computed", type=int, default=100, help="how many of them are computed as well")
    parser.add_argument("gaits", nargs="*", type=Path, help="default: reference and level gait of Table I, g1's own")
    asked = parser.parse_args()
    gc.disable()
    for name, robot, gait in [of_file(path) for path in asked.gaits] or by_default():
        report(name, robot, gait, asked.speeds, min(asked.computed, asked.speeds))


def of_file(path: Path) -> tuple[str, FrontalBiped, Gait]:
    gait = fb.load_gait(path)
    return path.name, fb.load_robot(gait.robot.name), gait


def by_default() -> list[tuple[str, FrontalBiped, Gait]]:
    robot = fb.load_robot()
    level = GaitSpecification(max_pelvis_roll=float(np.radians(5.0)))
    designs = {"reference": optimise_gait(robot).gait, "level": optimise_gait(robot, level).gait}
    found = [(name, robot, gait) for name, gait in designs.items() if gait is not None]
    return [*found, ("g1", fb.load_robot("g1"), fb.load_gait("g1"))]


def report(name: str, robot: FrontalBiped, gait: Gait, speeds: int, computed: int) -> None:
    if gait.look_ahead is None:
        began = time.process_time()
        gait = tabulated(robot, gait)
        print(f"{name}: tabulated in {time.process_time() - began:.0f} CPU s")
    assert gait.look_ahead is not None
    basin = RestrictedMap(robot, gait, LookAheadTransitions(robot, gait, look_up=False)).basin()
    by_table = RestrictedMap(robot, gait, LookAheadTransitions(robot, gait)).basin()
    print(f"{name}: {len(gait.look_ahead.low)} intervals; basin {basin}")
    print("  the same by the table" if by_table == basin else f"  ANOTHER by the table: {by_table}")
    looked_up, full = LookAheadTransitions(robot, gait), LookAheadTransitions(robot, gait, look_up=False)
    step = RestrictedMap(robot, gait, looked_up)
    found: dict[str, list[float]] = {"impact": [], "reversal": [], "impact, computed": [], "reversal, computed": []}
    different = 0
    for i, ratio in enumerate(np.random.default_rng(18).uniform(basin.low, basin.high, speeds)):
        start = step.start(float(ratio))
        rising = timed(found["impact"], lambda start=start: looked_up.rising(start))
        try:
            reversal = rising_energy(robot, rising).reversal(start.dbeta)
        except ReversalError:
            continue
        falling = timed(found["reversal"], lambda rising=rising, at=reversal: looked_up.falling(rising, at))
        if i >= computed:
            continue
        also = timed(found["impact, computed"], lambda start=start: full.rising(start))
        down = timed(found["reversal, computed"], lambda rising=rising, at=reversal: full.falling(rising, at))
        beta = np.linspace(reversal, gait.falling.beta_end, 9)
        off = np.max(np.abs(down.motion(beta).q - falling.motion(beta).q))
        different += bool(also.beta_end != rising.beta_end or off > SAME)
    tick = np.median(ticks(robot, gait))
    for what, times in found.items():
        p50, p99, most = np.percentile(times, [50, 99, 100])
        print(
            f"  {what:20} p50 {p50:8.3f} ms, 99 % {p99:8.3f}, most {most:8.3f};"
            f" over a walking tick {p50 / tick:7.1f}, {p99 / tick:7.1f}, {most / tick:7.1f}"
        )
    print(f"  answers other than computed: {different} of {computed}")


def timed(times: list[float], call: Callable[[], Answer]) -> Answer:
    """What a call answers; its CPU time is appended [ms]."""
    began = time.thread_time_ns()
    answer = call()
    times.append(1e-6 * (time.thread_time_ns() - began))
    return answer


def ticks(robot: FrontalBiped, gait: Gait) -> list[float]:
    """CPU times of ticks along the rising phase [ms]."""
    controller = QpController(robot, gait, ControllerSettings.for_gait(gait))
    times: list[float] = []
    for beta in np.linspace(gait.rising.beta_start, gait.rising.beta_end, 500):
        at = gait.rising.motion(np.array([beta]))
        q, dq = at.q[0], 0.5 * gait.speed_after_impact * at.dq[0]
        timed(times, lambda q=q, dq=dq: controller.command(StepPhase.RISING, q, dq))
    return times


if __name__ == "__main__":
    main()
