"""Push the robot at the pelvis, and see which stabiliser brings it back.

The frontal gait must never pass its energy barrier: pushed outwards it tips over the stance foot. The ankle law shifts
the FRI target inside the sole, at each impact and reversal; the step law chooses where to put the foot. No law moves
the FRI fast enough against a strong push, and where it leaves the sole the foot rolls over its edge.

You should see:

    mass 60.7 kg, J = 405.6 N^2 m s, pushed outwards just after the first impact
      10 N s, adaptive  walks on; back at its speed after 4 steps: False
      10 N s, ankle     walks on; back at its speed after 4 steps: True
      14 N s, adaptive  walks on; back at its speed after 4 steps: False
      14 N s, ankle     walks on; back at its speed after 4 steps: True
      20 N s, adaptive  falls: the stance foot rolled over its edge: the FRI left the sole
      20 N s, ankle     falls: the stance foot rolled over its edge: the FRI left the sole

Leave out `friction` and `rolls`, and the foot sticks whatever is asked of it: 20 N s are then survived, on paper. Or
try the shipped specification: `load_specification("robust")` is the gait to push.
"""

import numpy as np

import frontal_biped as fb
from frontal_biped.simulation import Disturbances
from frontal_biped.simulation.pushes import Push

PERIOD = 1e-3  # [s]
DURATION = 0.05  # [s] of a push
STEPS = 4
IMPULSES = (10.0, 14.0, 20.0)  # [N s]


def main() -> None:
    """Three pushes, two stabilisers."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0))), quick=True).gait
    assert gait is not None
    start = 0.02 * float(gait.step(robot).rising.duration)  # the first step stands on the left foot ...
    print(f"mass {robot.mass:.1f} kg, J = {gait.orbit.cost:.1f} N^2 m s, pushed outwards just after the first impact")
    for impulse in IMPULSES:
        for stabiliser in ("adaptive", "ankle"):
            push = Push(start, DURATION, impulse)  # ... so to the left is outwards
            run = fb.simulate(
                robot,
                gait,
                steps=STEPS,
                period=PERIOD,
                stabiliser=stabiliser,
                # the foot may slip, and roll over its edge
                disturbances=Disturbances(pushes=(push,), friction=gait.specification.friction, rolls=True),
            )
            if run.fell:
                print(f"{impulse:4.0f} N s, {stabiliser:8}  falls: {run.outcome}")
                continue
            error = run.post_impact_speeds[-1] / gait.orbit.beta_dot_after_impact - 1.0
            back = f"back at its speed after {STEPS} steps: {abs(error) < 0.05}"
            print(f"{impulse:4.0f} N s, {stabiliser:8}  walks on; {back}")
            assert abs(error) < 0.05 or stabiliser == "adaptive"


if __name__ == "__main__":
    main()
