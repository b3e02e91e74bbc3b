"""Walk with every joint free: TALOS in MuJoCo, from sensors only, on the gait of the plane, pushed on the way.

Held by a wrench at the sole, the planar gait is a motion of the whole robot. Its landing is another one: no motor holds
a knee for an impulse. A whole-body quadratic program takes the targets of the frontal law, and a sagittal law chooses
where the feet go. Fingers are held; everything else moves. Needs the extra `mujoco`.

You should see:

    to hold in space   CoP up to 8.1 mm ahead of the ankle, yaw moment up to 3.9 N m
    landing            19.2 N s in the plane, 3.3 N s with every joint free
    outcome            completed, 8 steps, 0.88 m
    pushed             8 N s to the left: step 0.762 s, the next 0.717 s
    speed              0.198 m/s in the last 3 steps, commanded 0.2
    step time          median 0.722 s, closed form 0.728 s
    CoP                76 mm inside the ends of the sole
    yaw drift          0.00 degrees

Push harder, or set FORWARDS = -0.1, and see what it takes.
"""

import numpy as np

import frontal_biped as fb
from frontal_biped.model import models_dir
from frontal_biped.simulation.space.pushes import SpatialPush
from frontal_biped.simulation.space.soles import pressure_in_sole, standing
from frontal_biped.simulation.space.steps import step_table

STEPS = 8
FORWARDS = 0.2  # [m/s], from 0
LAST = 3  # steps whose speed is told
PUSHED = 4  # step, from 0
PUSH = SpatialPush(start=0.1, duration=0.1, impulse=(0.0, 8.0, 0.0), step=PUSHED, phase="rising")  # [s], [N s]
BEARS = 0.1  # of the weight: with less, a foot that lands still rings


def main() -> None:
    """What the gait is in space, then the walk."""
    robot = fb.load_robot("talos_full")
    gait = fb.load_gait(models_dir() / "talos_full.gait.json")
    space = fb.analyze(robot, gait).in_space
    assert space is not None and space.landing is not None
    left, landing = space.holding[0], space.landing
    cop, yaw = (np.abs(values).max() for values in (left.cop_x, left.yaw_moment))
    print(f"to hold in space   CoP up to {1e3 * cop:.1f} mm ahead of the ankle, yaw moment up to {yaw:.1f} N m")
    planar, free = (landed.vertical_impulse for landed in (landing.planar, landing.described))
    print(f"landing            {planar:.1f} N s in the plane, {free:.1f} N s with every joint free")

    run = fb.walk_spatial(robot, gait, speed=FORWARDS, steps=STEPS, pushes=(PUSH,))
    steps = step_table(run)
    step_time, speed = float(np.median(steps.duration)), float(np.mean(steps.speed[-LAST:]))
    loaded = standing(run) & (run.wrench[:, :, 2] > BEARS * robot.weight)
    ahead = pressure_in_sole(run)[..., 0]  # of either foot, while it is the stance foot
    margin = min(
        float(np.min(np.minimum(cop + sole.back, sole.front - cop)[on]))
        for cop, on, sole in zip(ahead.T, loaded.T, robot.robot.soles, strict=True)
    )
    print(f"outcome            {run.outcome}, {run.steps_completed} steps, {run.com[-1, 0] - run.com[0, 0]:.2f} m")
    pushed, following = steps.duration[PUSHED : PUSHED + 2]
    print(f"pushed             {PUSH.impulse[1]:g} N s to the left: step {pushed:.3f} s, the next {following:.3f} s")
    print(f"speed              {speed:.3f} m/s in the last {LAST} steps, commanded {FORWARDS:g}")
    print(f"step time          median {step_time:.3f} s, closed form {gait.orbit.step_duration:.3f} s")
    print(f"CoP                {1e3 * margin:.0f} mm inside the ends of the sole")
    print(f"yaw drift          {np.degrees(run.yaw[-1] - run.yaw[0]):.2f} degrees")
    assert not run.fell


if __name__ == "__main__":
    main()
