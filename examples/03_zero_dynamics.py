"""The zero dynamics: what is left of the robot when it follows its virtual constraints.

dbeta = kappa_1 sigma_FRI, dsigma_FRI/dt = kappa_2 + kappa_3 sigma_FRI^2, hence with zeta = sigma_FRI^2 / 2

    dzeta/dbeta = kappa_2 / kappa_1 + 2 (kappa_3 / kappa_1) zeta,

which is linear. Both phases are integrated from the reversal, where zeta = 0, with beta = beta_r - Delta tau^2: every
integrand is then smooth and Gauss quadrature converges spectrally. Two independent routes must agree.

You should see:

    beta -1.6340 rad  kappa_1 0.02264  kappa_2 -69.523 N m  kappa_3 -0.001206
    beta -1.6547 rad  kappa_1 0.00911  kappa_2 -81.723 N m  kappa_3 0.000100
    beta -1.6754 rad  kappa_1 0.00214  kappa_2 -117.037 N m  kappa_3 -0.000619
    zeta at the impact, ODE solver     590.992820 kg^2 m^4/s^2
      quadrature with  8 nodes, error below 1e-04
      quadrature with 16 nodes, error below 1e-10
      quadrature with 24 nodes, error below 1e-10
    time of the fall                   0.4024 s

Try 4 nodes: they are wrong by a tenth.
"""

import numpy as np
from scipy.integrate import solve_ivp

import frontal_biped as fb
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import phase_orbit
from frontal_biped.zero_dynamics.restricted import restrict

NODES = (8, 16, 24)
TIGHT = 1e-12  # relative tolerance of the ODE solver


def main() -> None:
    """zeta at the impact by quadrature and by an ODE solver."""
    robot = fb.load_robot("frontal_biped")
    gait = fb.design_gait(robot, quick=True).gait
    assert gait is not None
    falling = gait.falling
    beta = np.linspace(falling.beta_start, falling.beta_end, 3)
    on_z = restrict(robot, falling, beta)
    for row in zip(beta, on_z.kappa_1, on_z.kappa_2, on_z.kappa_3, strict=True):
        print("beta {:.4f} rad  kappa_1 {:.5f}  kappa_2 {:.3f} N m  kappa_3 {:.6f}".format(*row))

    def slope(beta: float, zeta: np.ndarray) -> np.ndarray:
        here = restrict(robot, falling, np.array([beta]))
        return here.drive + here.rate * zeta

    ends = (falling.beta_start, falling.beta_end)
    zeta = solve_ivp(slope, ends, [0.0], rtol=TIGHT, atol=1e-14, method="DOP853").y[0, -1]
    print(f"zeta at the impact, ODE solver     {zeta:.6f} kg^2 m^4/s^2")
    errors = [abs(phase_orbit(robot, falling, StepPhase.FALLING, nodes).zeta[-1] / zeta - 1.0) for nodes in NODES]
    for nodes, error in zip(NODES, errors, strict=True):
        print(f"  quadrature with {nodes:2d} nodes, error below {10.0 ** np.ceil(np.log10(max(error, 1e-10))):.0e}")
    assert errors[-1] < 1e-9
    orbit = phase_orbit(robot, falling, StepPhase.FALLING, 24)
    print(f"time of the fall                   {orbit.duration:.4f} s")


if __name__ == "__main__":
    main()
