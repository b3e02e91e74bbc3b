"""The closed-form Poincare map: fixed point and slope, and the same map by integrating the zero dynamics."""

import numpy as np
import pytest
from random_states import assert_close
from scipy.integrate import solve_ivp

from frontal_biped.design.problem import DesignProblem
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model import impact
from frontal_biped.virtual_constraints import complete
from frontal_biped.zero_dynamics.poincare import HybridZeroDynamics, step_orbit
from frontal_biped.zero_dynamics.restricted import restrict

NODES = 40
"""Quadrature nodes at which the gaits are converged to rounding."""

ODE = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
"""Runge-Kutta of order 8 to nearly full precision."""

ODE_TOLERANCE = 1e-8
"""Relative agreement of the closed form with integration through two phases, an impact and an event."""

CLOSED = 1e-9
"""Relative size of residuals of the closed form on a designed gait, whose periodicity is solved to 1e-14."""

ROUNDING = 1e-11
"""Relative error of identities between a few operations."""


@pytest.fixture(params=["reference", "level"])
def gait(request, reference_gait, level_gait):
    return {"reference": reference_gait, "level": level_gait}[request.param]


@pytest.fixture
def hzd(biped, gait):
    return HybridZeroDynamics(biped, gait.step(biped, NODES))


@pytest.fixture(params=["biped", "low_torso", "raised_ankle"])
def any_hzd(request):
    """The map of a step that is no gait: the swayed stand from which a design starts, for each robot."""
    robot = request.getfixturevalue(request.param)
    problem = DesignProblem(robot, GaitSpecification(), 16)
    x = problem.start()
    x[-7:] += np.linspace(-0.02, 0.02, 7)
    rising, falling = complete(robot, problem.unpack(x))
    return HybridZeroDynamics(robot, step_orbit(robot, rising, falling, float(x[2]), NODES)), rising, falling


class TestDesignedGait:
    def test_fixed_point_is_fixed(self, hzd):
        zeta = hzd.fixed_point
        assert zeta > 0.0
        assert hzd.rho(zeta) == pytest.approx(zeta, rel=ROUNDING)

    def test_multiplier_is_the_slope(self, hzd):
        zeta, step = hzd.fixed_point, 0.1
        slope = (hzd.rho(zeta + step) - hzd.rho(zeta - step)) / (2.0 * step)
        assert slope == pytest.approx(hzd.multiplier, rel=ROUNDING)
        assert hzd.multiplier == pytest.approx(hzd.step.multiplier, rel=ROUNDING)

    def test_reversal_is_exactly_at_the_planned_point(self, hzd):
        """The fixed point arrives at beta_r- with no energy left: Z(beta_r-) = 0."""
        assert abs(hzd.marginal_condition) < CLOSED * abs(hzd.barrier_r)
        assert abs(hzd.rho_r(hzd.fixed_point)) < CLOSED * abs(hzd.barrier_r)
        assert hzd.rho_f(0.0) == pytest.approx(hzd.fixed_point, rel=CLOSED)
        assert abs(hzd.step.periodicity) < CLOSED * hzd.speed_after_impact**2

    def test_is_a_stable_gait(self, hzd):
        assert hzd.in_domain
        assert hzd.is_stable
        assert 0.0 < hzd.multiplier < 1.0

    def test_reversal_takes_energy_and_falling_returns_it(self, hzd):
        assert hzd.barrier_r > 0.0 > hzd.barrier_f

    def test_speeds_across_the_impact(self, biped, gait, hzd):
        """dbeta before the impact, through the full impact map, is dbeta after it."""
        falling = hzd.step.falling
        landing = impact(biped, falling.motion.q[-1], falling.motion.dq[-1] * falling.dbeta[-1])
        assert landing.dq_plus[0] == pytest.approx(hzd.speed_after_impact, rel=CLOSED)
        q, dq = gait.state_after_impact()
        assert_close(landing.q_plus, q, CLOSED)
        assert_close(landing.dq_plus, dq, CLOSED)

    def test_perturbation_decays_by_the_multiplier_each_step(self, hzd):
        zeta = 1.1 * hzd.fixed_point
        for step in range(1, 6):
            zeta = hzd.rho(zeta)
            error = zeta / hzd.fixed_point - 1.0
            assert error == pytest.approx(0.1 * hzd.multiplier**step, rel=1e-9)


def test_delta_z_is_the_momentum_transfer_of_the_paper(any_hzd):
    """[O] eq. restimpact: about the new ankle, without the landing foot, momentum is conserved.

    sigma_r+ = sigma_f- - p_4 m dp_cm_v - J_4 omega_4 - m_4 (p_4cm x dp_4cm), p_4 from ankle to ankle, p_4cm from
    the new ankle to the foot's centre of mass; the sense of rotation turns over with the relabelling.
    """
    hzd, *_ = any_hzd
    robot, falling = hzd.biped, hzd.step.falling
    q, dq = falling.motion.q[-1], falling.motion.dq[-1]
    h, v, sigma_0 = robot.momentum_map(q)[:3] @ dq
    sigma_f = sigma_0 + robot.ankle_height * h
    foot, ankle = robot.chain.bodies[4], robot.joint_positions(q)
    offset = foot.com - robot.chain.joints[3]
    levers = ankle[3] + offset - ankle
    foot_velocity = np.array([-levers[:, 1] @ dq, levers[:, 0] @ dq])
    of_the_foot = foot.inertia * dq.sum()
    of_the_foot += foot.mass * (offset[0] * foot_velocity[1] - offset[1] * foot_velocity[0])
    sigma_r = -(sigma_f - ankle[3, 0] * v - of_the_foot)
    assert hzd.delta_z == pytest.approx(sigma_r / sigma_f, rel=CLOSED)


def test_multiplier_two_ways(any_hzd):
    """By delta_r, delta_f, delta_z about the ankle, and by exponentials about the FRI and the speed ratio."""
    hzd, *_ = any_hzd
    assert hzd.multiplier == pytest.approx(hzd.step.multiplier, rel=CLOSED)


def test_fixed_point_of_any_step(any_hzd):
    hzd, *_ = any_hzd
    assert hzd.rho(hzd.fixed_point) == pytest.approx(hzd.fixed_point, rel=CLOSED)
    assert hzd.rho(2.0) == pytest.approx(hzd.rho_f(hzd.rho_r(2.0)), rel=ROUNDING)


def zeta_about_ankle(robot, phase, beta, zeta_fri):
    restricted = restrict(robot, phase, np.array([beta]))
    return float((restricted.I_ankle(robot.ankle_height)[0] / restricted.I_P[0]) ** 2 * zeta_fri)


def zeta_about_fri(robot, phase, beta, zeta_ankle):
    return zeta_ankle**2 / zeta_about_ankle(robot, phase, beta, zeta_ankle) if zeta_ankle else 0.0


def integrate_zeta(robot, phase, begin, end, zeta):
    def slope(beta, value):
        restricted = restrict(robot, phase, np.array([beta]))
        return restricted.drive + restricted.rate * value

    return float(solve_ivp(slope, (begin, end), [zeta], **ODE).y[0, -1])


@pytest.mark.parametrize("factor", [0.5, 1.0, 3.0])
def test_both_halves_of_the_map_against_integration_in_beta(any_hzd, factor):
    """rho_r and rho_f at a fixed reversal point: full impact, then the equation of zeta about the FRI."""
    hzd, rising, falling = any_hzd
    robot = hzd.biped
    zeta_f = factor * abs(hzd.fixed_point)
    end = falling.motion(np.array([falling.beta_end]))
    I_f = restrict(robot, falling, np.array([falling.beta_end])).I_ankle(robot.ankle_height)[0]
    landing = impact(robot, end.q[0], end.dq[0] * -np.sqrt(2.0 * zeta_f) / I_f)
    I_r = restrict(robot, rising, np.array([rising.beta_start])).I_P[0]
    zeta_r = integrate_zeta(robot, rising, rising.beta_start, rising.beta_end, 0.5 * (I_r * landing.dq_plus[0]) ** 2)
    zeta_r = zeta_about_ankle(robot, rising, rising.beta_end, zeta_r)
    scale = abs(hzd.barrier_r) + zeta_f
    assert hzd.rho_r(zeta_f) == pytest.approx(zeta_r, abs=ODE_TOLERANCE * scale)

    zeta_r = factor * 5.0
    start = zeta_about_fri(robot, falling, falling.beta_start, zeta_r)
    zeta_f = integrate_zeta(robot, falling, falling.beta_start, falling.beta_end, start)
    zeta_f = zeta_about_ankle(robot, falling, falling.beta_end, zeta_f)
    assert hzd.rho_f(zeta_r) == pytest.approx(zeta_f, abs=ODE_TOLERANCE * scale)


def return_in_time(robot, gait, zeta_f):
    """One step in time: impact, rise until the momentum vanishes wherever that is, fall to the impact."""
    rising, falling = gait.rising, gait.falling
    end = falling.motion(np.array([falling.beta_end]))
    I_f = restrict(robot, falling, np.array([falling.beta_end])).I_ankle(robot.ankle_height)[0]
    landing = impact(robot, end.q[0], end.dq[0] * -np.sqrt(2.0 * zeta_f) / I_f)
    sigma = restrict(robot, rising, np.array([rising.beta_start])).I_P[0] * landing.dq_plus[0]

    def flow(phase):
        def derivative(_, x):
            r = restrict(robot, phase, x[:1])
            return [r.kappa_1[0] * x[1], r.kappa_2[0] + r.kappa_3[0] * x[1] ** 2]

        return derivative

    def at_rest(_, x):
        return x[1]

    def at_impact(_, x):
        return x[0] - falling.beta_end

    for event in (at_rest, at_impact):
        event.terminal, event.direction = True, -1
    up = solve_ivp(flow(rising), (0.0, 3.0), [rising.beta_start, sigma], events=at_rest, **ODE)
    down = solve_ivp(flow(falling), (0.0, 3.0), [up.y[0, -1], 0.0], events=at_impact, **ODE)
    zeta_fri = 0.5 * down.y[1, -1] ** 2
    return zeta_about_ankle(robot, falling, falling.beta_end, zeta_fri), up.t[-1] + down.t[-1]


def test_fixed_point_and_duration_against_integration_in_time(biped, gait, hzd):
    zeta, duration = return_in_time(biped, gait, hzd.fixed_point)
    assert zeta == pytest.approx(hzd.fixed_point, rel=ODE_TOLERANCE)
    assert duration == pytest.approx(hzd.step.duration, rel=ODE_TOLERANCE)


def test_multiplier_is_the_slope_of_the_true_return_map(biped, gait, hzd):
    """The reversal point moves with the energy, and yet the slope is delta_f^2 delta_r^2 delta_z^2."""
    zeta, step = hzd.fixed_point, 1e-5 * hzd.fixed_point
    above, below = (return_in_time(biped, gait, zeta + d)[0] for d in (step, -step))
    # the map curves strongly: a relative step of 1e-4 already costs 1e-4 of the slope, 1e-5 costs 1e-6
    assert (above - below) / (2.0 * step) == pytest.approx(hzd.multiplier, rel=1e-5)


def test_reversal_point_off_the_plan_has_a_marginal_condition(biped, gait):
    """Beside beta_r- the fixed point does not reverse there: at a stable gait Z falls through zero."""
    signs = []
    for shift in (-1e-5, 1e-5):
        step = step_orbit(biped, gait.rising, gait.falling, gait.step_width, NODES, gait.beta_reversal + shift)
        signs.append(np.sign(HybridZeroDynamics(biped, step).marginal_condition))
    assert signs == [1.0, -1.0]
