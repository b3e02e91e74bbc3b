"""The return map in closed form: one step of the whole hybrid robot is an affine function of one number.

rho(zeta) = delta_f^2 delta_r^2 delta_z^2 zeta - ...; its fixed point is the gait, its slope the multiplier, and the
gait is stable if that lies between 0 and 1. The full model, simulated, must have the same slope.

You should see:

    delta_r 0.9993, delta_f 0.9976, delta_z -0.8718
    fixed point zeta_f*  584.430 kg^2 m^4/s^2, in the domain: True
    multiplier           0.7554, stable: True
    error step by step   20.00 15.11 11.41 8.62 6.51 4.92 %
      of the full model  0.7554

Try a start 50 % off: the speed still returns, 0.76 of the error a step.
"""

import numpy as np

import frontal_biped as fb
from frontal_biped.analysis.sensitivity import simulated_multiplier
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics


def main() -> None:
    """Deltas, fixed point, convergence of the map, and the slope of the simulated one."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, quick=True).gait
    assert gait is not None
    hzd = HybridZeroDynamics(robot, gait.step(robot))
    print(f"delta_r {hzd.delta_r:.4f}, delta_f {hzd.delta_f:.4f}, delta_z {hzd.delta_z:.4f}")
    print(f"fixed point zeta_f*  {hzd.fixed_point:.3f} kg^2 m^4/s^2, in the domain: {hzd.in_domain}")
    print(f"multiplier           {hzd.multiplier:.4f}, stable: {hzd.is_stable}")

    zeta = 1.2 * hzd.fixed_point  # 20 % too much energy at the impact
    errors = []
    for _ in range(6):
        errors.append(zeta / hzd.fixed_point - 1.0)
        zeta = hzd.rho(zeta)
    print("error step by step   " + " ".join(f"{100.0 * error:.2f}" for error in errors) + " %")
    ratios = np.array(errors[1:]) / np.array(errors[:-1])
    assert np.allclose(ratios, hzd.multiplier)  # the map is affine, so every step takes the same factor

    simulated = simulated_multiplier(robot, gait)
    print(f"  of the full model  {simulated:.4f}")
    assert abs(simulated / hzd.multiplier - 1.0) < 1e-3


if __name__ == "__main__":
    main()
