"""`SpatialWalker` beside a peer in the same plant: the divergent component of motion in both planes.

Run from the repository: ``OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_space_peer.py [options]``.

The peer (`peer_divergent_component`) has the same estimator, whole-body program, limits, weights, gains, sagittal law,
start, sensors and MuJoCo. It is tuned first, by a sweep of step duration, step width and rate k: most steps, and then
least torque, of a walk at 0.4 m/s that is pushed to the left and to the right. `SpatialWalker` is taken as it comes.
Then both, and the peer with the step duration of our gait:

* the fastest speed of those tried, downwards, that is held for so many steps;
* the largest push of those tried on the pelvis, 50 ms in +-x and +-y, on the spot, in the second step, after its start
  and half-way through; survived if four more steps are walked;
* torque squared per second on the spot, and per metre at a speed that both hold; step duration.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from frontal_biped.control.spatial_walker.interface import SpatialTickable
from frontal_biped.simulation.space.pushes import SpatialPush
from tests.benchmarks.peer_divergent_component import PeerSettings, PeerWalker
from tests.benchmarks.space_walks import Subject, torque_squared

DIRECTIONS = {"+x": (1.0, 0.0), "-x": (-1.0, 0.0), "+y": (0.0, 1.0), "-y": (0.0, -1.0)}
INSTANTS = {"after the landing": ("rising", 0.05), "half-way": ("falling", 0.0)}
PUSHED_STEP, STEPS_AFTER, PUSH_DURATION = 1, 4, 0.05  # [-], [-], [s]
SWEEP_SPEED, SWEEP_STEPS, SWEEP_IMPULSE = 0.4, 8, 30.0  # [m/s], [-], [N s]
SETTLED = 3  # steps before torques are counted

Maker = Callable[[float], SpatialTickable]
"""A controller for a commanded speed [m/s]."""


def tuned(subject: Subject, lift: float) -> PeerSettings:
    """The best of the sweep: durations and widths first, then the rate."""
    hip = subject.biped.hip_width
    best, record = PeerSettings(subject.duration, hip, lift=lift), (-1, -np.inf)
    tried: set[PeerSettings] = set()
    for variants in (
        [{"duration": T, "width": W} for T in (0.5, 0.6, subject.duration) for W in (hip, 1.2 * hip)],
        [{"rate": k} for k in (2.0, 5.0)],
    ):
        for settings in [replace(best, **variant) for variant in variants]:
            if settings in tried:
                continue
            tried.add(settings)
            pushes = tuple(
                SpatialPush(0.05, PUSH_DURATION, (0.0, sign * SWEEP_IMPULSE, 0.0), step=step, phase="rising")
                for step, sign in ((3, 1.0), (5, -1.0))
            )
            run = subject.walk(PeerWalker(subject.free, settings, speed=SWEEP_SPEED), SWEEP_STEPS, pushes)
            torque, _ = torque_squared(run, 0.0)
            print(
                f"  T {settings.duration:.2f} s, W {settings.width:.3f} m, k {settings.rate:.0f}/s:"
                f" {run.steps_completed} of {SWEEP_STEPS} steps, {torque:.0f} (N m)^2 ({run.outcome})",
                flush=True,
            )
            if (run.steps_completed, -torque) > record:
                best, record = settings, (run.steps_completed, -torque)
    return best


def fastest(subject: Subject, make: Maker, speeds: list[float], steps: int) -> str:
    """The fastest speed held, and what became of the next faster one."""
    beyond = "not tried"
    for speed in speeds:
        run = subject.walk(make(speed), steps)
        if not run.fell:
            reached = float(np.mean(subject.table(run).speed[-5:]))
            return f"{speed:.1f} m/s asked, {reached:.2f} walked; faster: {beyond}"
        beyond = f"{run.outcome} after {run.steps_completed} steps"
    return f"none; {beyond}"


def pushed(subject: Subject, make: Maker, impulses: list[float]) -> dict[str, list[float]]:
    """The first of the impulses that is survived [N s], by instant and direction; 0 for none."""
    found: dict[str, list[float]] = {}
    for name, (phase, start) in INSTANTS.items():
        for x, y in DIRECTIONS.values():
            survived = 0.0
            for size in impulses:
                push = SpatialPush(start, PUSH_DURATION, (size * x, size * y, 0.0), step=PUSHED_STEP, phase=phase)
                if not subject.walk(make(0.0), PUSHED_STEP + 1 + STEPS_AFTER, (push,)).fell:
                    survived = size
                    break
            found.setdefault(name, []).append(survived)
    return found


def effort(subject: Subject, make: Maker, speed: float, steps: int) -> str:
    """Torque squared, step duration and speed of a steady walk."""
    run = subject.walk(make(speed), steps)
    if run.fell:
        return f"{run.outcome} after {run.steps_completed} steps"
    table = subject.table(run)
    per_second, per_metre = torque_squared(run, float(table.start[SETTLED]))
    along = f", {per_metre:.0f} (N m)^2 s/m" if speed else ""
    return (
        f"{per_second:.0f} (N m)^2{along}; T {np.mean(table.duration[SETTLED:]):.3f} s;"
        f" {np.mean(table.speed[SETTLED:]):.3f} m/s"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="talos_full")
    parser.add_argument("--steps", type=int, default=30, help="for which a speed is held")
    parser.add_argument("--speeds", type=float, nargs="+", default=[0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2])
    parser.add_argument(
        "--impulses", type=float, nargs="+", default=[40.0, 30.0, 20.0, 10.0], help="in this order, N s"
    )
    parser.add_argument("--effort-steps", type=int, default=12)
    parser.add_argument("--effort-speed", type=float, default=0.3)
    parser.add_argument("--only", nargs="+", help="of the controllers: ours, peer, same (peer with T as ours)")
    parser.add_argument("--peer", type=float, nargs=3, metavar=("T", "W", "K"), help="in place of the sweep")
    parser.add_argument(
        "--parts", nargs="+", choices=("speed", "pushes", "effort"), default=["effort", "pushes", "speed"]
    )
    chosen = parser.parse_args()
    subject = Subject(chosen.robot)
    ours = subject.walk(subject.walker(), 2)
    lift = float(ours.sole_position[:, :, 2].max())
    print(f"{chosen.robot}: peer's swing sole lifted as ours, {1e3 * lift:.0f} mm", flush=True)
    if chosen.peer:
        T, W, k = chosen.peer
        best = PeerSettings(T, W, rate=k, lift=lift)
    else:
        best = tuned(subject, lift)
    print(f"peer: T {best.duration:.2f} s, W {best.width:.3f} m, k {best.rate:.0f}/s", flush=True)
    makers: dict[str, Maker] = {
        "ours": lambda speed: subject.walker(speed),
        "peer": lambda speed: PeerWalker(subject.free, best, speed=speed),
    }
    if abs(best.duration - subject.duration) > 0.01:
        same = replace(best, duration=subject.duration)
        makers["same"] = lambda speed: PeerWalker(subject.free, same, speed=speed)
    if chosen.only:
        makers = {name: makers[name] for name in chosen.only}
    for part in chosen.parts:
        for name, make in makers.items():
            if part == "effort":
                for speed in (0.0, chosen.effort_speed):
                    print(f"{name:5} {speed:.1f} m/s: {effort(subject, make, speed, chosen.effort_steps)}", flush=True)
            elif part == "pushes":
                for when, sizes in pushed(subject, make, chosen.impulses).items():
                    text = ", ".join(f"{d} {size:.0f}" for d, size in zip(DIRECTIONS, sizes, strict=True))
                    print(f"{name:5} push {when}: {text} N s", flush=True)
            else:
                print(f"{name:5} fastest: {fastest(subject, make, chosen.speeds, chosen.steps)}", flush=True)


if __name__ == "__main__":
    main()
