"""What is said of MuJoCo: steps, step times, everything wrong at once, largest pushes in both engines.

Run from the repository: ``OMP_NUM_THREADS=1 python tests/benchmarks/benchmark_mujoco.py [steps|trials|pushes] ...``.

* ``steps N ROBOT ...``: N steps of each robot's stored gait, of frontal_biped's gait `rough`, in both engines;
* ``trials N STEPS``: N seeded trials of the gait `rough` in two processes, everything wrong at once;
* ``pushes``: the largest push survived at four instants, in both directions and both engines.

What it printed, with the walker over the sway:

* Seven humanoids on their gaits, 20 steps: no fall; step time within 1 % of the closed form (alexander 6 %), speed
  half-way down within 2.3 % (alexander 5 %).
* Table I robot, `rough`; every link's mass and inertia within 20 %, CoM within 2 cm, friction 0.3 to 0.9, torque noise
  2 %, encoder and roll noise 1e-4 rad, 3 ms delay, ground within 3 mm: 20 of 20 seeded trials walked 30 steps.

And over beta, the ankle's angle (`Walker(over="ankle")`), as all planar walks before:

* talos_full, romeo, g1 on their stored gaits, 200 steps: no fall; step times 0.732, 0.301, 0.304 s, closed form
  0.728, 0.300, 0.300 s.
* The same trials: 100 of 100 walked 100 steps (95 % interval from 96 %), and 60 of 60 with seeds that nothing was
  chosen on.
* Largest push of 50 ms after which `rough` still walks 6 steps, of those tried up to 60 N s, MuJoCo and ours, N s:

      just after the impact    outwards 11, 15    inwards 49, 33
      half-way up              outwards 14, 20    inwards 46, 49
      at the reversal          outwards 24, 32    inwards 30, 35
      half-way down            outwards 39, 49    inwards 19, 24

"""

import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from frontal_biped import load_gait, load_robot
from frontal_biped.analysis.cross_check import cross_check
from frontal_biped.design import optimise_gait
from frontal_biped.gait import load_specification
from frontal_biped.gait.gait import Gait
from frontal_biped.model import FrontalBiped
from frontal_biped.model.perturbation import ModelErrors
from frontal_biped.simulation import Disturbances, Push, Trajectory
from frontal_biped.simulation.walking import walk

ENGINES = ("mujoco", "ours")
INSTANTS = (("just after the impact", 0.02), ("half-way up", 0.5), ("at the reversal", 1.0), ("half-way down", 1.5))
PUSH_DURATION, PUSH_STEPS, LARGEST_PUSH = 0.05, 6, 60.0  # [s], after the push, [N s]


def rough() -> tuple[FrontalBiped, Gait]:
    """The Table I robot and its gait for rough going."""
    biped = load_robot("frontal_biped")
    gait = optimise_gait(biped, load_specification("rough")).gait
    assert gait is not None
    return biped, gait


def describe(run: Trajectory) -> str:
    """One line on a run."""
    times = np.diff(run.event_t[run.events("IMPACT")])
    measured = {name: f"{value['mean']:.3g}/{value['largest']:.3g}" for name, value in run.settings["measured"].items()}
    mean = f"T {times.mean():.4f} +- {times.std():.4f} s" if len(times) else "no step"
    return f"{run.steps_completed} steps, {run.outcome}; {mean}; mean/largest {measured}"


def steps(count: str, *robots: str) -> None:
    """N steps in both engines."""
    for name in robots:
        if name == "frontal_biped":
            biped, gait = rough()
        else:
            biped = load_robot(name)
            gait = load_gait(biped.path.with_name(f"{name}.gait.json"))
        check, _ = cross_check(biped, gait, steps=int(count))
        print(f"{check}\nstep times differ by {check.step_time_difference:+.2%}\n", flush=True)


def trial(job: tuple[int, int]) -> tuple[int, int, str]:
    """One seeded trial: links, friction, noise, delay, ground."""
    seed, count = job
    biped, gait = rough()
    generator = np.random.default_rng(seed)
    errors = ModelErrors.draw(generator, mass=0.2, com=0.02, inertia=0.2)
    disturbances = Disturbances(
        encoder_noise=1e-4,
        imu_noise=1e-4,
        torque_noise=0.02,
        delay=0.003,
        ground_height=0.003,
        friction=float(generator.uniform(0.3, 0.9)),
        seed=seed,
    )
    run = walk(biped, gait, steps=count, errors=errors, disturbances=disturbances)
    return seed, run.steps_completed, describe(run)


def trials(number: str, count: str) -> None:
    """Everything wrong at once."""
    walked = []
    with ProcessPoolExecutor(2) as executor:
        for seed, completed, text in executor.map(trial, [(seed, int(count)) for seed in range(int(number))]):
            walked.append(completed == int(count))
            print(f"{seed:3d} {text}", flush=True)
    print(f"{sum(walked)} of {len(walked)} trials walked {count} steps")


def largest(biped: FrontalBiped, gait: Gait, engine: str, start: float, sign: float) -> tuple[float, str]:
    """Largest impulse survived [N s], to 1 N s or a tenth, and what became of the next larger one."""

    def survives(impulse: float) -> tuple[bool, str]:
        push = Push(start, PUSH_DURATION, sign * impulse)
        run = walk(biped, gait, engine=engine, steps=PUSH_STEPS, disturbances=Disturbances(pushes=(push,)))
        return not run.fell, run.outcome

    good, bad, why, size = 0.0, None, "nothing up to the end of the search", 4.0
    while size <= LARGEST_PUSH:
        walks, outcome = survives(size)
        if not walks:
            bad, why = size, outcome
            break
        if size == LARGEST_PUSH:
            return size, "nothing up to the end of the search"
        good, size = size, min(2.0 * size, LARGEST_PUSH)
    while bad is not None and bad - good > max(1.0, 0.1 * good):
        middle = 0.5 * (good + bad)
        walks, outcome = survives(middle)
        good, bad, why = (middle, bad, why) if walks else (good, middle, outcome)
    return good, why


def pushes() -> None:
    """The table of pushes."""
    biped, gait = rough()
    step = gait.step(biped)
    up, down = step.rising.duration, step.falling.duration
    for name, place in INSTANTS:
        start = place * up if place <= 1.0 else up + (place - 1.0) * down
        for direction, sign in (("outwards", 1.0), ("inwards", -1.0)):  # the left foot stands first
            found = {engine: largest(biped, gait, engine, start, sign) for engine in ENGINES}
            text = "; ".join(f"{engine} {size:.1f} N s ({why})" for engine, (size, why) in found.items())
            print(f"{name}, {direction}: {text}", flush=True)


if __name__ == "__main__":
    {"steps": steps, "trials": trials, "pushes": pushes}[sys.argv[1]](*sys.argv[2:])
