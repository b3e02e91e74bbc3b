"""From a slider to a new certified gait: wall and processor time of 20 changes, as the studio makes them.

    python tests/benchmarks/benchmark_studio.py [--robot R] [--changes N]

"Designed" is when the screen gets a gait that keeps C01 to C09 on the dense grid, has residuals below 1e-9 and has been
simulated for a step; the closed-form certificate of the reversal point follows in a second process and is not waited
for. Each change starts from the gait before it. Processor time is the designing process's own.

A second table says whether the screen goes on meanwhile: how late a 30 Hz clock in the studio's process ticks while a
design runs, in a process of its own as in the studio and, for comparison, in a thread.
"""

import argparse
import os
import statistics
import tempfile
import threading
import time
from pathlib import Path

from frontal_biped.design import optimise_gait
from frontal_biped.studio.workbench import Workbench
from frontal_biped.studio.worker import NewestFirst

CHANGES = (
    ("max_pelvis_roll", 15.0), ("max_pelvis_roll", 12.0), ("step_duration", (0.45, 0.7)), ("swing_clearance", 14.0),
    ("max_pelvis_roll", 10.0), ("step_duration", (0.5, 0.6)), ("friction", 0.5), ("swing_clearance", 18.0),
    ("touchdown_speed", 0.08), ("max_pelvis_roll", 8.0), ("fri_margin", 8.0), ("step_duration", (0.5, 0.8)),
    ("min_energy_margin", 0.6), ("max_pelvis_roll", 9.0), ("friction", 0.6), ("swing_clearance", 10.0),
    ("touchdown_speed", 0.05), ("min_energy_margin", 0.0), ("fri_margin", 5.0), ("max_pelvis_roll", 14.0),
)  # fmt: skip
"""One slider after another, as a user would explore; in the units shown."""

TICK = 1.0 / 30.0


def processor_seconds(pid):
    """User and system time of a process [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def wait(workbench, done):
    while not done(workbench.state):
        time.sleep(0.005)


def measure(robot, changes):
    """(slider, wall, processor time, outcome) of every change, and the designing process."""
    made = {}

    def make(listener, name):
        made[name] = NewestFirst(listener, name)
        return made[name]

    with tempfile.TemporaryDirectory() as folder:
        workbench = Workbench(robot, Path(folder), make)
        workbench.begin()
        designer = made["studio-designer"]
        wait(workbench, lambda state: state.fits or state.explanation)
        rows = []
        for key, value in changes:
            before, began = processor_seconds(designer.pid), time.perf_counter()
            workbench.turn(key, value)
            wait(workbench, lambda state: not state.designing)
            state = workbench.state
            spent = processor_seconds(designer.pid) - before
            outcome = f"J = {state.gait.orbit.cost:.1f}" if state.fits else state.explanation[:50]
            rows.append((f"{key} = {value}", time.perf_counter() - began, spent, outcome))
        late = lateness(lambda: workbench.turn("max_pelvis_roll", 6.0), lambda: workbench.state.designing)
        workbench.close()
    return rows, late


def lateness(begin, running):
    """Delays of a 30 Hz clock while something runs [s]."""
    begin()
    delays = []
    while running():
        due = time.perf_counter() + TICK
        time.sleep(TICK)
        delays.append(time.perf_counter() - due)
    return delays


def in_a_thread(robot):
    """The same clock beside a design in a thread."""
    from frontal_biped.gait import GaitSpecification
    from frontal_biped.model import load_robot

    thread = threading.Thread(target=lambda: optimise_gait(load_robot(robot), GaitSpecification(max_pelvis_roll=0.1)))
    return lateness(thread.start, thread.is_alive)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="frontal_biped")
    parser.add_argument("--changes", type=int, default=len(CHANGES))
    arguments = parser.parse_args()
    rows, late = measure(arguments.robot, CHANGES[: arguments.changes])
    for name, wall, spent, outcome in rows:
        print(f"{name:34} {wall:6.2f} s   {spent:6.2f} s of processor   {outcome}")
    for title, column in (("wall time", 1), ("processor time", 2)):
        values = [row[column] for row in rows]
        print(f"{title:15} median {statistics.median(values):.2f} s, largest {max(values):.2f} s of {len(values)}")
    for title, delays in (("process", late), ("thread", in_a_thread(arguments.robot))):
        middle, worst = 1e3 * statistics.median(delays), 1e3 * max(delays)
        print(f"a 30 Hz clock beside a design in a {title:7}: {middle:5.1f} ms late (median), {worst:.0f} ms at most")


if __name__ == "__main__":
    main()
