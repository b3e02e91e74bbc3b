"""What each part of `SpatialWalker` is worth: walks without it.

Run from the repository: ``OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_space_ablations.py [options]``.

On the spot and forwards, MuJoCo, exact sensors: steps walked before a fall, their mean duration against the closed
form, and by how much the frontal speed half-way down is off that of the gait, in the mean and in the last step.
"""

import argparse
from collections.abc import Callable

import numpy as np

from frontal_biped.control.frontal_law import FrontalSettings
from frontal_biped.control.spatial_walker.leg_lengths import LengthSettings
from frontal_biped.control.spatial_walker.walker import SpatialWalker
from frontal_biped.control.walker.phase_machine import PhaseMachine
from tests.benchmarks.space_ablations import AnkleLaw, JointPd, RollJointState
from tests.benchmarks.space_walks import Subject

SETTLED = 3
"""Steps that do not count in the means, where as many are left."""


def whole(subject: Subject, speed: float) -> SpatialWalker:
    return subject.walker(speed)


def without_learning(subject: Subject, speed: float) -> SpatialWalker:
    return subject.walker(speed, frontal=FrontalSettings(learning=0.0))


def without_energy(subject: Subject, speed: float) -> SpatialWalker:
    return subject.walker(speed, frontal=FrontalSettings(energy=None, learning=0.0))


def roll_joints(subject: Subject, speed: float) -> SpatialWalker:
    made = subject.walker(speed)
    made.state = RollJointState(subject.free, subject.biped)
    return made


def over_beta(subject: Subject, speed: float) -> SpatialWalker:
    made = subject.walker(speed)
    made.frontal = AnkleLaw(made)  # type: ignore[assignment]
    made.phases = PhaseMachine(made.period)
    return made


def without_lift(subject: Subject, speed: float) -> SpatialWalker:
    return subject.walker(speed, lengths=LengthSettings(lift=0.0))


def joint_pd(stiffness: float, damping: float) -> Callable[[Subject, float], SpatialWalker]:
    def walker(subject: Subject, speed: float) -> SpatialWalker:
        made = over_beta(subject, speed)
        made.program = JointPd(made, stiffness, damping)  # type: ignore[assignment]
        return made

    return walker


ABLATIONS: dict[str, Callable[[Subject, float], SpatialWalker]] = {
    "all of it": whole,
    "no learning from step to step": without_learning,
    "no energy law, no learning": without_energy,
    "legs not drawn up": without_lift,
    "beta, not the sway, as the phase": over_beta,
    "roll joints as outputs": roll_joints,
    "joint PD, 2000 N m/rad": joint_pd(2000.0, 90.0),
    "joint PD, 10000 N m/rad": joint_pd(10000.0, 200.0),
}


def row(subject: Subject, make: Callable[[Subject, float], SpatialWalker], speed: float, steps: int) -> str:
    """One cell of the table."""
    run = subject.walk(make(subject, speed), steps)
    table = subject.table(run)
    text = f"{run.steps_completed:2d} of {steps}"
    if len(table.step):
        late = slice(SETTLED if len(table.step) > SETTLED else 0, None)
        off = 100.0 * (np.abs(table.mid_fall_speed) / abs(subject.mid_fall_speed) - 1.0)
        known = off[late][np.isfinite(off[late])]
        middle = f"{np.mean(known):+.1f}" if len(known) else "-"
        text += f", T {np.mean(table.duration[late]):.3f} s, half-way down {middle} (last {off[-1]:+.1f}) %"
    return text + (f", {run.outcome}" if run.fell else f", {np.mean(table.speed[late]):.2f} m/s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="talos_full")
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.0, 0.2])
    parser.add_argument("--only", nargs="+", help="words of the rows to run")
    chosen = parser.parse_args()
    subject = Subject(chosen.robot)
    print(f"{chosen.robot}: closed form T {subject.duration:.3f} s, half-way down {subject.mid_fall_speed:.3f} rad/s")
    for name, make in ABLATIONS.items():
        if chosen.only and not any(word in name for word in chosen.only):
            continue
        for speed in chosen.speeds:
            print(f"{name:33} {speed:.1f} m/s: {row(subject, make, speed, chosen.steps)}", flush=True)


if __name__ == "__main__":
    main()
