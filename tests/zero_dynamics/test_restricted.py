"""Zero dynamics: independent numbers, integration in beta and in time, and the full dynamics on the orbit."""

from itertools import pairwise

import numpy as np
import pytest
from random_states import assert_close
from scipy.integrate import simpson, solve_ivp

from frontal_biped.design.problem import DesignProblem
from frontal_biped.exceptions import ReversalError
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.virtual_constraints import Phase, complete
from frontal_biped.virtual_constraints.phase import StepPhase
from frontal_biped.zero_dynamics.orbit import phase_orbit, resample
from frontal_biped.zero_dynamics.restricted import restrict

INDEPENDENT_TOLERANCE = 1e-9
"""Relative, against the symbolic model; both sides carry about 1e-13 of rounding."""

ODE = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}
"""Runge-Kutta of order 8 to nearly full precision: the other route to every integral."""

ODE_TOLERANCE = 1e-9
"""Relative agreement of quadrature and Runge-Kutta."""

ROUNDING = 1e-10
"""Relative error of identities between numbers computed along different lines of the package."""

NODES = 40
"""Quadrature nodes at which the motions below are converged to rounding."""

PHASES = tuple(kind.value for kind in StepPhase)


@pytest.fixture(scope="session")
def walks(robots, reference_gait, level_gait):
    """Robot and two phases: the designed gaits, and the swayed stand from which a design starts."""
    biped = robots["table1"]
    found = {
        "reference": (biped, reference_gait.rising, reference_gait.falling),
        "level": (biped, level_gait.rising, level_gait.falling),
    }
    for name in ("table1_low_torso", "raised_ankle"):
        problem = DesignProblem(robots[name], GaitSpecification(), 16)
        x = problem.start()
        x[-7:] += np.linspace(-0.02, 0.02, 7)  # a moving FRI, so that kappa_3 counts
        found[name] = (robots[name], *complete(robots[name], problem.unpack(x)))
    return found


WALKS = ("reference", "level", "table1_low_torso", "raised_ankle")


@pytest.fixture(params=[(walk, name) for walk in WALKS for name in PHASES], ids="-".join)
def case(request, walks):
    """(robot, phase, whether it rises or falls)."""
    walk, name = request.param
    robot, rising, falling = walks[walk]
    return robot, rising if name == "rising" else falling, StepPhase(name)


def ends(phase, kind):
    """(beta at the reversal, beta at the impact)."""
    return (phase.beta_end, phase.beta_start) if kind is StepPhase.RISING else (phase.beta_start, phase.beta_end)


class TestAgainstTheIndependentModel:
    def test_kappa(self, robot, robot_name, independent):
        data = independent[robot_name]["zero_dynamics"]
        phase = Phase(
            data["beta_start"], data["beta_end"], np.array(data["joint_bezier"]), np.array(data["fri_bezier"])
        )
        rows = {key: np.array([row[key] for row in data["rows"]]) for key in data["rows"][0]}
        motion = phase.motion(rows["beta"])
        assert_close(motion.q, rows["q"], INDEPENDENT_TOLERANCE)
        assert_close(motion.dq, rows["dq_dbeta"], INDEPENDENT_TOLERANCE)
        assert_close(motion.ddq, rows["d2q_dbeta2"], INDEPENDENT_TOLERANCE)
        assert_close(motion.p_fri, rows["p_fri"], INDEPENDENT_TOLERANCE)
        restricted = restrict(robot, phase, rows["beta"])
        for name in ("kappa_1", "kappa_2", "kappa_3"):
            for value, expected in zip(getattr(restricted, name), rows[name], strict=True):
                assert value == pytest.approx(expected, rel=INDEPENDENT_TOLERANCE)


def test_kappa_by_definition(case):
    robot, phase, _ = case
    beta = np.linspace(phase.beta_start, phase.beta_end, 9)
    motion, restricted = phase.motion(beta), restrict(robot, phase, beta)
    I_P = np.array([robot.sigma(q, dq, float(p)) for q, dq, p in zip(*motion[:2], motion.p_fri, strict=True)])
    com = np.array([robot.com(q) for q in motion.q])
    com_v_slope = np.array([robot.com_velocity(q, dq)[1] for q, dq in zip(*motion[:2], strict=True)])
    assert_close(restricted.kappa_1, 1.0 / I_P, ROUNDING)
    assert_close(restricted.kappa_2, -robot.weight * (com[:, 0] - motion.p_fri), ROUNDING)
    kappa_3 = -robot.mass * motion.dp_fri * com_v_slope / I_P**2
    assert_close(restricted.kappa_3, kappa_3, ROUNDING, floor=1e-6)
    assert_close(restricted.drive, restricted.kappa_2 / restricted.kappa_1, ROUNDING)
    assert_close(restricted.rate, 2.0 * restricted.kappa_3 / restricted.kappa_1, ROUNDING, floor=1e-3)


def test_angular_momentum_about_the_ankle(case):
    robot, phase, _ = case
    beta = np.linspace(phase.beta_start, phase.beta_end, 5)
    motion, restricted = phase.motion(beta), restrict(robot, phase, beta)
    momenta = [robot.momentum_map(q)[:3] @ dq for q, dq in zip(*motion[:2], strict=True)]
    about_ankle = [sigma + robot.ankle_height * h for h, _, sigma in momenta]
    assert_close(restricted.I_ankle(robot.ankle_height), about_ankle, ROUNDING)


def test_zeta_against_runge_kutta_in_beta(case):
    """dzeta/dbeta = kappa_2/kappa_1 + 2 (kappa_3/kappa_1) zeta from zeta = 0 at the reversal."""
    robot, phase, kind = case
    reversal, impact = ends(phase, kind)
    orbit = phase_orbit(robot, phase, kind, NODES)

    def slope(beta, zeta):
        restricted = restrict(robot, phase, np.array([beta]))
        return restricted.drive + restricted.rate * zeta

    solution = solve_ivp(slope, (reversal, impact), [0.0], t_eval=orbit.beta, **ODE)
    assert_close(orbit.beta[[0, -1]], [reversal, impact], ROUNDING)
    assert_close(orbit.zeta, solution.y[0], ODE_TOLERANCE)


def test_momentum_and_moment_against_runge_kutta_in_time(case):
    """dbeta = kappa_1 sigma, dsigma = kappa_2 + kappa_3 sigma^2 in time, to or from the reversal."""
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    reversal, impact = ends(phase, kind)

    def flow(_, x):
        restricted = restrict(robot, phase, x[:1])
        return [restricted.kappa_1[0] * x[1], restricted.kappa_2[0] + restricted.kappa_3[0] * x[1] ** 2]

    if kind is StepPhase.RISING:
        start = [impact, float(np.sqrt(2.0 * orbit.zeta[-1]))]

        def event(_, x):
            return x[1]
    else:
        start = [reversal, 0.0]

        def event(_, x):
            return x[0] - impact

    event.terminal, event.direction = True, -1
    solution = solve_ivp(flow, (0.0, 5.0), start, events=event, **ODE)
    beta_end, sigma_end = solution.y[:, -1]
    assert solution.t[-1] == pytest.approx(orbit.duration, rel=ODE_TOLERANCE)
    if kind is StepPhase.RISING:
        assert beta_end == pytest.approx(reversal, abs=ODE_TOLERANCE)
    else:
        assert 0.5 * sigma_end**2 == pytest.approx(orbit.zeta[-1], rel=ODE_TOLERANCE)


def test_quadrature_converges_spectrally(case):
    """The error of zeta at the impact falls by more than ten for every eight nodes until rounding."""
    robot, phase, kind = case

    def figure(size):
        return float(phase_orbit(robot, phase, kind, size).zeta[-1])

    exact = figure(64)
    errors = [abs(figure(size) - exact) / abs(exact) for size in (8, 16, 24, 32)]
    floor = 1e-12  # rounding of the sums
    for coarse, fine in pairwise(errors):
        assert fine < max(0.1 * coarse, floor), errors
    assert errors[-1] < floor


@pytest.mark.parametrize("energy", [0.9, 1.0, 1.5])
def test_energy_law_of_the_phase(case, energy):
    """zeta + V_Z = delta^2 zeta+ along a phase, for whatever energy it starts with."""
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    reversal, impact = ends(phase, kind)
    start, end = (impact, reversal) if kind is StepPhase.RISING else (reversal, impact)
    zeta_plus = energy * (abs(orbit.zeta[-1]) if kind is StepPhase.RISING else 1.0)

    def slope(beta, x):  # zeta, V_Z, log delta^2
        restricted = restrict(robot, phase, np.array([beta]))
        drive, rate = restricted.drive[0], restricted.rate[0]
        return [drive + rate * x[0], -drive + rate * x[1], rate]

    beta = orbit.beta[:: -int(kind.sign)]
    zeta, V_Z, log_delta_squared = solve_ivp(slope, (start, end), [zeta_plus, 0.0, 0.0], t_eval=beta, **ODE).y
    size = np.abs(orbit.zeta).max()
    assert_close(zeta + V_Z, np.exp(log_delta_squared) * zeta_plus, ODE_TOLERANCE, floor=size)
    # V_Z and delta of the package are those of the differential equations
    assert_close(orbit.V_Z[:: -int(kind.sign)], V_Z, ODE_TOLERANCE, floor=size)
    exponent = orbit.log_delta_squared - orbit.log_delta_squared[-1 if kind is StepPhase.RISING else 0]
    assert_close(exponent[:: -int(kind.sign)], log_delta_squared, ODE_TOLERANCE, floor=1.0)


def test_acceleration_is_the_rate_of_the_speed(case):
    """ddbeta = d(dbeta^2/2)/dbeta."""
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    tau, step = np.linspace(0.1, 0.9, 7), 1e-5
    here = resample(robot, phase, orbit, tau)
    after, before = (resample(robot, phase, orbit, tau + d) for d in (step, -step))
    slope = (after.dbeta**2 - before.dbeta**2) / 2.0 / (after.beta - before.beta)
    # differences of step 1e-5 have 1e-9 of rounding and truncation
    assert_close(here.ddbeta, slope, 1e-7)


def test_acceleration_in_the_form_of_the_paper(case):
    """ddbeta = -(I_P'/I_P) dbeta^2 + (kappa_2 + kappa_3 sigma^2)/I_P."""
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    speed_squared = np.linspace(0.0, 0.2, orbit.tau.size)
    step = 1e-6
    slope = (restrict(robot, phase, orbit.beta + step).I_P - restrict(robot, phase, orbit.beta - step).I_P) / (2 * step)
    r = orbit.restricted
    expected = -slope / r.I_P * speed_squared + (r.kappa_2 + r.kappa_3 * r.I_P**2 * speed_squared) / r.I_P
    assert_close(r.acceleration(speed_squared), expected, 1e-7)  # accuracy of the difference


def test_torques_on_the_orbit_satisfy_the_pinned_dynamics(case):
    """The closed-form orbit is a motion of the full robot, FRI on target, reaction from Newton."""
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    motion, w = orbit.motion, orbit.generalized_forces
    for i in range(0, orbit.tau.size, 3):
        q, dq = motion.q[i], motion.dq[i] * orbit.dbeta[i]
        ddq = motion.ddq[i] * orbit.dbeta[i] ** 2 + motion.dq[i] * orbit.ddbeta[i]
        u = w[3:, i]
        assert_close(robot.D(q) @ ddq + robot.C(q, dq) @ dq + robot.G(q), u, ROUNDING, floor=10.0)
        assert_close(robot.ground_reaction(q, dq, ddq), w[:2, i], ROUNDING)
        assert robot.fri(q, dq, ddq) == pytest.approx(motion.p_fri[i], abs=ROUNDING)
        assert robot.torque_from_fri(float(motion.p_fri[i]), w[:2, i]) == pytest.approx(u[0], abs=1e-8)


def test_cost_and_duration_are_integrals_over_time(biped, reference_gait):
    for name in PHASES:
        phase, kind = getattr(reference_gait, name), StepPhase(name)
        orbit = phase_orbit(biped, phase, kind, NODES)
        fine = resample(biped, phase, orbit, np.linspace(0.0, 1.0, 4001))
        # time from positions and speeds alone: dt = d beta / dbeta between neighbours, trapezoidal in tau
        density = np.abs(np.gradient(fine.beta, fine.tau)[1:] / fine.dbeta[1:])
        assert_close(density[1:-1], fine.time_density[2:-1], 1e-6)
        u_squared = (fine.generalized_forces[3:] ** 2).sum(axis=0) * fine.time_density
        assert orbit.duration == pytest.approx(simpson(fine.time_density, x=fine.tau), rel=ODE_TOLERANCE)
        assert orbit.squared_torque == pytest.approx(simpson(u_squared, x=fine.tau), rel=ODE_TOLERANCE)


def test_speed_signs(biped, reference_gait):
    rising = phase_orbit(biped, reference_gait.rising, StepPhase.RISING, NODES)
    falling = phase_orbit(biped, reference_gait.falling, StepPhase.FALLING, NODES)
    assert np.all(rising.dbeta[1:] > 0.0) and np.all(falling.dbeta[1:] < 0.0)
    assert rising.dbeta[0] == falling.dbeta[0] == 0.0
    assert rising.ddbeta[0] < 0.0  # gravity pulls back at the reversal (HIP2)


def test_resampling_keeps_the_orbit(case):
    robot, phase, kind = case
    orbit = phase_orbit(robot, phase, kind, NODES)
    same = resample(robot, phase, orbit, orbit.tau)
    assert_close(same.zeta, orbit.zeta, ROUNDING)
    assert_close(same.log_delta_squared, orbit.log_delta_squared, ROUNDING, floor=1e-3)


def test_reversal_below_the_impact_is_an_error(biped, reference_gait):
    phase = reference_gait.rising
    with pytest.raises(ReversalError, match="not above the impact"):
        phase_orbit(biped, phase, StepPhase.RISING, 16, phase.beta_start - 0.01)
