"""A gait library on one and on two worker processes: gaits a second, efficiency, a million of them, and three kills.

    python tests/benchmarks/benchmark_library.py [--points 1000] [--kill]

Points are spread over clearance and pelvis roll. Quote the efficiency; the rate belongs to the machine, which must have
two cores to spare. A worker is a process with one thread. How long a million gaits take on a cluster is worked out from
the rate of one worker, the efficiency of two, and the processor time that the building process spends itself, for
handing out, progress and index; it counts on a file system that keeps up. With --kill the library is built once more,
its process killed three times at random moments (seeded) and taken up again; the index must come out byte for byte the
same.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from frontal_biped.library import LibraryReport, build_library, worker_processes
from frontal_biped.library.sweep import Sweep, sweep_from_dict

SEED = 0


def make_sweep(points: int) -> Sweep:
    """A grid of about the given number of points; 50 along the pelvis roll."""
    lines = max(1, round(points / 50))
    return sweep_from_dict(
        {
            "batch": 25,
            "specification": {"step_width": [0.2, 0.35]},
            "sweep": {
                "swing_clearance": {"from": 0.006, "to": 0.02, "count": lines},
                "max_pelvis_roll": {"from": 0.09, "to": 0.25, "count": min(points, 50)},
            },
        },
        "benchmark",
    )


def show(name: str, report: LibraryReport) -> None:
    """One line a run."""
    print(
        f"{name:14} {report.points} points, {report.gaits} gaits, {report.failures} without one,"
        f" {report.seconds:.1f} s, {report.gaits_per_second:.2f} a second",
        flush=True,
    )


MILLION = 1_000_000

CLUSTERS = (16, 64, 256, 1024)
"""Workers."""


def a_million(rate: float, efficiency: float, own: float) -> None:
    """What a million gaits would take: workers at the measured rate and efficiency, the builder by itself.

    Args:
        rate: of one worker [1/s].
        efficiency: of two workers [-].
        own: processor time of the building process for a point [s].
    """
    print(f"the building process takes {1e3 * own:.2f} ms a point of its own, {MILLION * own / 3600.0:.2f} h a million")
    for workers in CLUSTERS:
        designing = MILLION / (rate * min(efficiency, 1.0) * workers)
        # designing and handing out overlap; index and checks, the greater part of its own, do not
        print(f"a million gaits on {workers:4} workers: {(designing + MILLION * own) / 3600.0:.1f} h")


def killed_three_times(sweep: Sweep, folder: Path, seconds: float) -> None:
    """Build with two processes, killed at three random moments of the time that it takes undisturbed."""
    moments = random.Random(SEED)
    code = (
        "import json, sys; from pathlib import Path\n"
        "from frontal_biped.library import build_library, worker_processes\n"
        "from frontal_biped.library.sweep import sweep_from_dict\n"
        "if __name__ == '__main__':\n"
        "    sweep = sweep_from_dict(json.loads(Path(sys.argv[1]).read_text()), 'sweep')\n"
        "    with worker_processes(2) as executor:\n"
        "        build_library(sweep, Path(sys.argv[2]), executor)\n"
    )
    import json

    table, script = folder.with_suffix(".json"), folder.with_suffix(".py")
    table.write_text(json.dumps(sweep.as_dict()))
    script.write_text(code)
    command = [sys.executable, str(script), str(table), str(folder)]
    for _ in range(3):
        run = subprocess.Popen(command)
        time.sleep(moments.uniform(0.1, 0.3) * seconds + 3.0)
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
        print(f"killed with {len(list((folder / 'gaits').glob('0*.json')))} gaits", flush=True)
    subprocess.run(command, check=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=1000)
    parser.add_argument("--kill", action="store_true")
    arguments = parser.parse_args()
    sweep = make_sweep(arguments.points)
    with tempfile.TemporaryDirectory() as folder:
        reports, own = {}, 0.0
        for count in (1, 2):
            with worker_processes(count) as executor:
                for future in [executor.submit(time.sleep, 0.5) for _ in range(count)]:
                    future.result()  # workers up and running
                began = time.process_time()
                reports[count] = build_library(sweep, Path(folder) / str(count), executor)
                own = (time.process_time() - began) / reports[count].points
            show(f"{count} process(es)", reports[count])
        efficiency = reports[1].seconds / (2.0 * reports[2].seconds)
        same = (Path(folder) / "1/index.csv").read_bytes() == (Path(folder) / "2/index.csv").read_bytes()
        print(f"efficiency of two processes {efficiency:.2f}; index {'identical' if same else 'DIFFERENT'}")
        a_million(reports[1].gaits_per_second, efficiency, own)
        if arguments.kill:
            killed_three_times(sweep, Path(folder) / "killed", reports[2].seconds)
            again = (Path(folder) / "killed/index.csv").read_bytes()
            print(f"killed three times: index {'identical' if again == reports[1].index.read_bytes() else 'DIFFERENT'}")


if __name__ == "__main__":
    main()
