"""Virtual constraints: Bezier polynomials in the phase variable beta, made hybrid invariant by their first columns.

q_b = h_d(beta) and p_FRI = h_d^FRI(beta). Pose and slope carry through impact and reversal only if the first two
columns of each phase follow from the phase before: `complete` computes them, so a designer never sees them.

You should see:

    rising  beta -1.6540 .. -1.6340 rad, 6 columns
    falling beta -1.6340 .. -1.6754 rad
    s = 0.0  h_d = -1.4957 -1.4581 -1.6754 rad, FRI  15.7 mm
    s = 0.5  h_d = -1.3108 -1.6952 -1.4892 rad, FRI   5.6 mm
    s = 1.0  h_d = -1.1857 -1.8193 -2.5059 rad, FRI  -8.6 mm
    invariance of the gait        below 1e-9: True
    second column off by 0.01 rad 0.20 of slope lost
    completed from the free ones  below 1e-9: True

Try to change another column than the second: nothing is lost, these are free.
"""

from dataclasses import replace

import numpy as np

import frontal_biped as fb
from frontal_biped.virtual_constraints import Phase, complete, invariance_residuals
from frontal_biped.virtual_constraints.invariance import free_parameters


def main() -> None:
    """Look at the constraints of a gait, spoil a column, and let invariance repair it."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, quick=True).gait
    assert gait is not None
    rising = gait.rising
    print(f"rising  beta {rising.beta_start:.4f} .. {rising.beta_end:.4f} rad, {rising.degree + 1} columns")
    print(f"falling beta {gait.falling.beta_start:.4f} .. {gait.falling.beta_end:.4f} rad")
    motion = rising.motion(np.linspace(rising.beta_start, rising.beta_end, 3))
    for s, q, p_fri in zip((0.0, 0.5, 1.0), motion.q, motion.p_fri, strict=True):
        angles = " ".join(f"{value:7.4f}" for value in q[1:])
        print(f"s = {s:.1f}  h_d = {angles} rad, FRI {1e3 * p_fri:5.1f} mm")

    def worst(first: Phase, second: Phase) -> float:
        return max(invariance_residuals(robot, first, second, gait.step_width).values())

    print(f"invariance of the gait        below 1e-9: {worst(rising, gait.falling) < 1e-9}")
    spoilt = rising.joint_bezier.copy()
    spoilt[0, 1] += 0.01  # [rad], second column of the stance hip: the slope after the impact
    loss = worst(replace(rising, joint_bezier=spoilt), gait.falling)
    print(f"second column off by 0.01 rad {loss:.2f} of slope lost")
    # the free parameters alone give the phases back
    again = complete(robot, free_parameters(rising, gait.falling, gait.step_width))
    print(f"completed from the free ones  below 1e-9: {worst(*again) < 1e-9}")
    assert np.allclose(again[0].joint_bezier, rising.joint_bezier, atol=1e-9)


if __name__ == "__main__":
    main()
