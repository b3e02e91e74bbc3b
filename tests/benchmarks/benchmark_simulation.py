"""What a simulated second costs: continuous, at 1 kHz, under the walker in our engine and in MuJoCo.

python tests/benchmarks/benchmark_simulation.py [--against FOLDER] [--steps N] [--repeats N]

On the Table I robot and its gait, CPU time of the process over the simulated time, the least of a few repeats after one
run that is thrown away. ``--against`` names another checkout of this repository; the two then take turns in processes
of their own, so that both meet the same load, and the ratio is what may be quoted.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).resolve().parents[2]
CASES = ("continuous", "continuous, one state at a time", "1 kHz", "walker", "walker in MuJoCo")

DESIGN = """
import sys
import frontal_biped as fb
from frontal_biped.design import optimise_gait
from frontal_biped.gait.file import save_gait
save_gait(optimise_gait(fb.load_robot()).gait, sys.argv[1])
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--measure", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.measure is not None:
        measure(arguments.measure, arguments.steps)
        return
    folders = [HERE] if arguments.against is None else [HERE, arguments.against.resolve()]
    least: list[dict[str, float]] = [{} for _ in folders]
    with tempfile.TemporaryDirectory() as kept:
        gait = Path(kept) / "gait.json"
        subprocess.run([sys.executable, "-c", DESIGN, gait], check=True, cwd=HERE, env=of(HERE))
        command = [sys.executable, __file__, "--measure", gait, "--steps", str(arguments.steps)]
        for _ in range(arguments.repeats):
            for folder, best in zip(folders, least, strict=True):
                found = subprocess.run(command, check=True, capture_output=True, text=True, cwd=folder, env=of(folder))
                for case, seconds in json.loads(found.stdout).items():
                    best[case] = min(best.get(case, seconds), seconds)
    print("CPU ms per simulated second")
    for case in CASES:
        shown = [f"{1e3 * best[case]:7.1f}" for best in least if case in best]
        ratio = f"   {least[1][case] / least[0][case]:.2f} times as fast" if len(shown) == 2 else ""
        print(f"  {case:32}", *shown, ratio)


def of(folder: Path) -> dict[str, str]:
    """The environment of a process that uses the package of a checkout, on one thread."""
    return {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def measure(gait_file: Path, steps: int) -> None:
    """Print what this checkout needs for every case [s/s]."""
    import frontal_biped as fb
    from frontal_biped.control import ControllerSettings, QpController
    from frontal_biped.control.stabilisers.by_name import make_stabiliser
    from frontal_biped.exceptions import MissingExtraError
    from frontal_biped.simulation import SimulationSettings, simulate_walk
    from frontal_biped.simulation.walking import simulate, start_state, walk

    class OneByOne(QpController):
        """Asked for one state after another, as users' controllers are."""

    robot, gait = fb.load_robot(), fb.load_gait(gait_file)
    settings = SimulationSettings(steps=steps, rtol=1e-8, atol=1e-10)

    def one_by_one() -> fb.Trajectory:
        stabiliser = make_stabiliser("fixed", robot, gait)
        controller = OneByOne(robot, gait, ControllerSettings.for_gait(gait), stabiliser)
        return simulate_walk(robot, controller, start_state(gait), settings)

    plain = {"steps": steps, "simulation_settings": settings}
    runs: dict[str, Callable[[], fb.Trajectory]] = {
        "continuous": lambda: simulate(robot, gait, period=None, stabiliser="fixed", **plain),
        "continuous, one state at a time": one_by_one,
        "1 kHz": lambda: simulate(robot, gait, period=1e-3, stabiliser="re-anchored", **plain),
        "walker": lambda: simulate(robot, gait, period=1e-3, **plain),
        "walker in MuJoCo": lambda: walk(robot, gait, steps=steps),
    }
    found = {}
    for case, run in runs.items():
        try:
            run()
        except MissingExtraError:
            continue
        began = time.process_time()
        walked = run()
        found[case] = (time.process_time() - began) / float(walked.t[-1])
    print(json.dumps(found))


if __name__ == "__main__":
    main()
