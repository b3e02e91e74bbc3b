"""From a URDF to a verified step: design a gait, certify it, walk it; then ask for the impossible.

`design_gait` minimises J = (1/L_s) int u'u dt under C01 to C09. It closes the orbit to rounding, checks every
constraint on a grid forty times denser, and simulates a step of the full model. Without ``quick=True`` the robot then
walks 20 steps with torques held for 1 ms before anything is called a gait.

You should see:

    certified              True
    cost J                 210.22 N^2 m s
    largest residual       below 1e-9
    step                   0.800 s, 0.350 m wide
    steps walked           3, completed
    post-impact states     repeat: True
    pelvis within 5 deg    J = 405.58 N^2 m s
    and with 0.001 rad and 5 cm of clearance there is none: max_pelvis_roll pelvis roll, rising, ...

Leave out `advise=False`: a change of one entry that leaves a gait is looked for, tried, and named.
"""

import numpy as np

import frontal_biped as fb


def main(steps: int = 3) -> None:
    """Design, certify, walk; a tighter specification; an impossible one."""
    robot = fb.load_robot("frontal_biped")
    specification = fb.GaitSpecification()

    result = fb.design_gait(robot, specification, quick=True)
    gait = result.gait
    assert gait is not None, result.message
    analysis = fb.analyze(robot, gait, certify=False)
    run = fb.simulate(robot, gait, steps=steps, period=None)  # continuous control; else 1 kHz
    states = run.post_impact_states()
    print(f"certified              {analysis.certified}")
    print(f"cost J                 {analysis.cost:.2f} N^2 m s")
    print(f"largest residual       {'below 1e-9' if max(analysis.residuals.values()) < 1e-9 else 'too large'}")
    print(f"step                   {analysis.step_duration:.3f} s, {gait.step_width:.3f} m wide")
    print(f"steps walked           {run.steps_completed}, {run.outcome}")
    print(f"post-impact states     repeat: {np.max(np.abs(states - states[0])) < 1e-7}")

    tight = fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0)))
    level = fb.design_gait(robot, tight, quick=True)
    assert level.gait is not None, level.message
    print(f"pelvis within 5 deg    J = {level.gait.orbit.cost:.2f} N^2 m s")

    impossible = fb.design_gait(
        robot, fb.GaitSpecification(max_pelvis_roll=0.001, swing_clearance=0.05), advise=False, quick=True
    )
    assert impossible.gait is None
    heaviest = impossible.conflicts[0]
    print(f"and with 0.001 rad and 5 cm of clearance there is none: {heaviest.code} {heaviest.name}, ...")


if __name__ == "__main__":
    main()
