"""What a user waits for, before and after a change: processor time of commands with all the processes they start.

    python tests/benchmarks/benchmark_waiting.py --before TREE [--only demo] [--runs 3]

``TREE`` is another checkout of this project, run beside this one in turn; without it only this one is measured. The
processor time of a command is that of its whole tree of processes, browser included, so that it says something on a
busy machine too; it is looked at ten times a second, and what a process does after the last look is missing. Linux
only. Wall times are printed for what they are worth.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).parents[2]
TICK = os.sysconf("SC_CLK_TCK")
LOOK = 0.1
"""Time between two looks at the processes [s]."""

COMMANDS = {
    "import": ["-c", "import frontal_biped"],
    "demo": ["-m", "frontal_biped", "demo", "--out", "demo"],
    "card": ["-m", "frontal_biped", "analyze", "gait.json", "--robustness"],
    "gif": ["-m", "frontal_biped", "export", "run.npz", "-o", "run.gif"],
    "gif 640x480, 20 fps": [
        "-m",
        "frontal_biped",
        "export",
        "run.npz",
        "-o",
        "r.gif",
        "--size",
        "640x480",
        "--fps",
        "20",
    ],
}
"""What is measured, as arguments of Python; the run is 20 steps of the reference gait, 16 s."""

PREPARED = (
    ["-m", "frontal_biped", "design", "-o", "gait.json"],
    ["-m", "frontal_biped", "simulate", "gait.json", "--steps", "20", "--continuous", "-o", "run.npz"],
)


def processes():
    """Parent and processor time [s] of every process there is."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            except OSError:
                continue
            found[int(entry.name)] = (int(fields[1]), (int(fields[11]) + int(fields[12])) / TICK)
    return found


def measured(tree, arguments, folder):
    """(processor, wall) time of a command of a checkout [s]."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    began = time.perf_counter()
    run = subprocess.Popen([sys.executable, *arguments], cwd=folder, env=environment, stdout=subprocess.DEVNULL)
    spent = {run.pid: 0.0}
    while run.poll() is None:
        now = processes()
        for pid, (parent, seconds) in sorted(now.items()):
            if pid in spent or parent in spent:
                spent[pid] = max(spent.get(pid, 0.0), seconds)
        time.sleep(LOOK)
    if run.returncode:
        raise SystemExit(f"{tree}: {' '.join(arguments)} failed with {run.returncode}")
    return sum(spent.values()), time.perf_counter() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--only", choices=COMMANDS, action="append")
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    trees = {"now": HERE} if arguments.before is None else {"before": arguments.before.resolve(), "now": HERE}
    with tempfile.TemporaryDirectory() as folder:
        for command in PREPARED:
            measured(HERE, command, folder)
        for name in arguments.only or COMMANDS:
            found = {which: [] for which in trees}
            for _ in range(arguments.runs):
                for which, tree in trees.items():
                    found[which].append(measured(tree, COMMANDS[name], folder))
            middle = {
                which: [statistics.median(column) for column in zip(*runs, strict=True)]
                for which, runs in found.items()
            }
            told = ", ".join(f"{which} {cpu:.2f} s of processor, {wall:.1f} s" for which, (cpu, wall) in middle.items())
            share = f": {middle['now'][0] / middle['before'][0]:.2f} of before" if "before" in middle else ""
            print(f"{name:20} {told}{share}", flush=True)


if __name__ == "__main__":
    main()
