"""Load a robot, and ask it for its dynamics.

Coordinates are the paper's: q = (stance ankle, stance hip, swing hip, swing ankle), all -pi/2 when upright; h points
from the stance foot to the swing foot, v up. D(q) ddq + C(q, dq) dq + G(q) = u, from Pinocchio.

You should see:

    mass        60.70 kg
    leg, hips   0.800 m, 0.200 m
    upright CoM 0.100 m from the stance ankle, 0.849 m high
    eigenvalues of D   0.03, 0.63, 5.52, 56.58 kg m^2
    power balance      True
    an impact takes    0.43 J

Try `fb.load_robot("talos_full")`: the same numbers for a humanoid, locked at its posture.
"""

import numpy as np

import frontal_biped as fb
from frontal_biped.model.impact import impact

UPRIGHT = np.full(4, -np.pi / 2)  # [rad]


def main() -> None:
    """Sizes, dynamics at a pose, and what an impact does."""
    robot = fb.load_robot("frontal_biped")  # Table I of the paper
    print(f"mass        {robot.mass:.2f} kg")
    print(f"leg, hips   {robot.leg_length:.3f} m, {robot.hip_width:.3f} m")
    print(f"upright CoM {robot.com(UPRIGHT)[0]:.3f} m from the stance ankle, {robot.com(UPRIGHT)[1]:.3f} m high")

    # the mass matrix is symmetric and positive definite; power in equals energy gained
    rng = np.random.default_rng(0)
    q, dq, u = UPRIGHT + 0.2 * rng.normal(size=4), rng.normal(size=4), 20.0 * rng.normal(size=4)
    D = robot.D(q)
    print(f"eigenvalues of D   {', '.join(f'{value:.2f}' for value in np.linalg.eigvalsh(robot.D(UPRIGHT)))} kg m^2")
    assert np.allclose(D, D.T) and np.all(np.linalg.eigvalsh(D) > 0.0)
    ddq = robot.forward_dynamics(q, dq, u)
    h = 1e-6
    ahead = robot.energy(q + h * dq + 0.5 * h**2 * ddq, dq + h * ddq)
    behind = robot.energy(q - h * dq + 0.5 * h**2 * ddq, dq - h * ddq)
    print(f"power balance      {abs((ahead - behind) / (2.0 * h) - dq @ u) < 1e-4 * abs(dq @ u)}")

    # a level two-legged stance, the swing foot coming down: the impact costs energy, and the feet change roles
    q_minus = np.array([-1.65, -1.4915926536, -1.4915926536, -1.65])
    dq_minus = np.array([-0.5, 0.3, 0.3, -0.1])
    landed = impact(robot, q_minus, dq_minus)
    before, after = robot.energy(q_minus, dq_minus), robot.energy(landed.q_plus, landed.dq_plus)
    print(f"an impact takes    {before - after:.2f} J")
    assert after < before and np.allclose(landed.q_plus, q_minus[::-1])


if __name__ == "__main__":
    main()
