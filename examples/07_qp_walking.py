"""Walk in the full model under the quadratic program, at 1 kHz, and see why transitions must adapt.

The QP tracks y = q_b - h_d(beta) and the FRI within friction, unilateral contact, sole and torque limits. Torques are
held for a millisecond. With the paper's fixed transitions a small error of the reversal is lost invariance; adaptive
transitions re-anchor the falling phase where the robot really reverses.

You should see:

    10 steps at 1 kHz: completed; 0 of the programs unsolved
    worst output error     1.2 mrad
    largest torque         31 N m of 150
    friction used          0.16 of 0.6
    1 % too fast, fixed    walks, invariance lost: 0.009 rad
    1 % too fast, adaptive walks, invariance lost: below 1e-5 rad

Try PERIOD = 4e-3: held four times as long, the torques let the outputs stray by 24 mrad.
"""

import numpy as np

import frontal_biped as fb
from frontal_biped.simulation.settings import SimulationSettings

PERIOD = 1e-3  # [s]
QUICK = SimulationSettings(rtol=1e-7, atol=1e-9)


def main(steps: int = 10) -> None:
    """Sampled control, its limits, and a start 1 % too fast."""
    robot = fb.load_robot("frontal_biped")
    specification = fb.GaitSpecification(max_pelvis_roll=float(np.radians(5.0)))
    gait = fb.design_gait(robot, specification, quick=True).gait
    assert gait is not None

    run = fb.simulate(robot, gait, steps=steps, period=PERIOD, stabiliser="adaptive")  # told the state
    torque, sideways = np.max(np.abs(run.u)), np.max(np.abs(run.force[:, 0] / run.force[:, 1]))
    counted = run.settings["controller"]
    print(f"{run.steps_completed} steps at 1 kHz: {run.outcome}; {counted['unsolved']} of the programs unsolved")
    print(f"worst output error     {1e3 * np.max(np.abs(run.output_error)):.1f} mrad")
    print(f"largest torque         {torque:.0f} N m of {robot.max_torque[0]:.0f}")
    print(f"friction used          {sideways:.2f} of {specification.friction}")
    outer, inner = robot.sole
    assert torque <= robot.max_torque[0] and np.all((run.p_fri >= outer) & (run.p_fri <= inner))

    for stabiliser in ("fixed", "adaptive"):
        off = fb.simulate(
            robot, gait, steps=3, period=None, speed_error=0.01, stabiliser=stabiliser, simulation_settings=QUICK
        )
        lost = np.max(np.abs(off.output_error))
        fate = "walks" if not off.fell else f"falls after {off.steps_completed} steps"
        size = f"{lost:.3f} rad" if lost > 1e-3 else "below 1e-5 rad" if lost < 1e-5 else f"{lost:.1e} rad"
        print(f"1 % too fast, {stabiliser:8} {fate}, invariance lost: {size}")


if __name__ == "__main__":
    main()
