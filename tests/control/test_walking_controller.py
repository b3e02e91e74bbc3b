"""The walking controller: input-output linearisation while no limit acts, and every limit kept when one does."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import assert_close, vectors

from frontal_biped.control import ControllerSettings, QpController
from frontal_biped.design.problem import DesignProblem
from frontal_biped.gait.gait import Gait, OrbitNumbers, RobotReference
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model import load_robot
from frontal_biped.virtual_constraints import StepPhase, complete
from frontal_biped.zero_dynamics.orbit import phase_orbit

CLOSED_FORM = 1e-8
"""Relative agreement of the program with the closed form, both to the solver's 1e-9."""

LIMIT_TOLERANCE = 1e-6
"""How far a limit may be overstepped, relative to the weight (force) or the weight on 0.1 m (torque)."""

ACTIVE = 1e-4
"""Relative distance at which a limit counts as active."""

SETTINGS = ControllerSettings()

phases = st.sampled_from(list(StepPhase))


@pytest.fixture(scope="module")
def gaits(biped, reference_gait, robots):
    """A gait for each robot; for those not designed, the virtual constraints from which a design starts."""
    found = {"table1": reference_gait}
    for name in ("table1_low_torso", "raised_ankle"):
        robot = robots[name]
        problem = DesignProblem(robot, GaitSpecification(), 16)
        x = problem.start()
        x[-7:] += np.linspace(-0.02, 0.02, 7)
        rising, falling = complete(robot, problem.unpack(x))
        orbit = OrbitNumbers(0.5, 1.0, 0.5, 1.0, 0.5)
        found[name] = Gait(RobotReference(name, "", ""), rising, falling, float(x[2]), orbit)
    return found


@pytest.fixture(scope="module")
def gait(gaits, robot_name):
    return gaits[robot_name]


@pytest.fixture(scope="module")
def controller(robot, gait):
    return QpController(robot, gait)


def phase_of(gait, which):
    return gait.rising if which is StepPhase.RISING else gait.falling


def state(gait, which, s, dbeta, y, dy):
    """A state with given output errors at phase value s."""
    phase = phase_of(gait, which)
    beta = phase.beta_start + s * phase.range
    h_d, h_d1, *_ = phase.desired(beta)
    return np.r_[beta, h_d + y], np.r_[dbeta, h_d1 * dbeta + dy]


def closed_form(robot, gait, which, q, dq, settings):
    """(ddq, u, F, N_0) of the input-output linearising torque with the FRI on its target, from inverse dynamics.

    Accelerations are ddq = a + b ddbeta with ddq_b = h_d' ddbeta + h_d'' dbeta^2 - Kd dy - Kp y; the one unknown left
    follows from N_0 = p_FRI F_v.
    """
    h_d, h_d1, h_d2, p = phase_of(gait, which).desired(float(q[0]))
    y, dy = q[1:] - h_d, dq[1:] - h_d1 * dq[0]
    wanted = -2.0 * settings.damping * settings.frequency * dy - settings.frequency**2 * y
    a, b = np.r_[0.0, h_d2 * dq[0] ** 2 + wanted], np.r_[1.0, h_d1]
    w_a = robot.inverse_dynamics(q, dq, a)
    w_b = robot.inverse_dynamics(q, dq, a + b) - w_a
    ddbeta = -(w_a[2] - p * w_a[1]) / (w_b[2] - p * w_b[1])
    w = w_a + w_b * ddbeta
    return a + b * ddbeta, w[3:], w[:2], w[2]


def limits(robot, settings, u, F, N_0):
    """Room left to every limit, relative; negative where overstepped."""
    outer, inner = robot.sole
    lever = 0.1 * robot.weight
    return {
        "torque": float(np.min(robot.max_torque - np.abs(u))) / lever,
        "unilateral": (F[1] / robot.weight - settings.min_normal_force),
        "friction": (settings.friction * F[1] - abs(F[0])) / robot.weight,
        "fri": min(N_0 - outer * F[1], inner * F[1] - N_0) / lever,
    }


small = {"y": vectors(-0.003, 0.003, 3), "dy": vectors(-0.03, 0.03, 3)}


@given(which=phases, s=st.floats(0.0, 1.0), dbeta=st.floats(-0.3, 0.3), **small)
def test_closed_form_while_no_limit_acts(robot, gait, controller, which, s, dbeta, y, dy):
    q, dq = state(gait, which, s, dbeta, y, dy)
    ddq, u, F, N_0 = closed_form(robot, gait, which, q, dq, SETTINGS)
    assume(min(limits(robot, SETTINGS, u, F, N_0).values()) > ACTIVE)
    command = controller.command(which, q, dq)
    assert command.solved
    assert_close(command.u, u, CLOSED_FORM, floor=robot.weight * 0.1)
    assert_close(command.force, F, CLOSED_FORM)
    assert_close(command.ddq, ddq, CLOSED_FORM, floor=100.0)


@given(which=phases, s=st.floats(0.0, 1.0), dbeta=st.floats(-0.3, 0.3), **small)
def test_output_obeys_its_error_dynamics(robot, gait, controller, which, s, dbeta, y, dy):
    """ddy = -Kd dy - Kp y under the full forward dynamics, and the FRI is where it should be."""
    q, dq = state(gait, which, s, dbeta, y, dy)
    _, u, F, N_0 = closed_form(robot, gait, which, q, dq, SETTINGS)
    assume(min(limits(robot, SETTINGS, u, F, N_0).values()) > ACTIVE)
    command = controller.command(which, q, dq)
    assert_close(command.y, y, CLOSED_FORM, floor=1e-3)
    assert_close(command.dy, dy, CLOSED_FORM, floor=1e-2)
    ddq = robot.forward_dynamics(q, dq, command.u)
    _, h_d1, h_d2, p = phase_of(gait, which).desired(float(q[0]))
    ddy = ddq[1:] - h_d1 * ddq[0] - h_d2 * dq[0] ** 2
    k_p, k_d = SETTINGS.frequency**2, 2.0 * SETTINGS.damping * SETTINGS.frequency
    # the light foot (0.03 kg m^2) turns the solver's 1e-8 N m into 1e-6 rad/s^2
    assert_close(ddy, -k_d * dy - k_p * y, 1e-6, floor=10.0)
    assert command.p_fri_target == pytest.approx(p, abs=1e-12)
    assert robot.fri(q, dq, ddq) == pytest.approx(p, abs=1e-8)


@pytest.mark.parametrize("which", list(StepPhase))
def test_on_the_orbit_the_command_is_the_torque_of_the_zero_dynamics(biped, reference_gait, which):
    controller = QpController(biped, reference_gait)
    phase = phase_of(reference_gait, which)
    orbit = phase_orbit(biped, phase, which, 32)
    for i in range(0, 32, 4):
        command = controller.command(which, orbit.motion.q[i], orbit.motion.dq[i] * orbit.dbeta[i])
        assert_close(command.u, orbit.generalized_forces[3:, i], 1e-7)
        assert_close(command.y, np.zeros(3), 1e-12, floor=1.0)
    assert controller.unsolved == 0


def adversarial_states(gait, count, seed):
    """States far off the virtual constraints, slow and fast."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        which = StepPhase(rng.choice(["rising", "falling"]))
        size = 10.0 ** rng.uniform(-3.0, -0.5)
        y, dy = size * rng.normal(size=3), 10.0 * size * rng.normal(size=3)
        yield which, *state(gait, which, rng.uniform(-0.1, 1.1), 2.0 * size * rng.normal(), y, dy)


ADVERSE = {
    "as designed": (ControllerSettings(), None),
    "slippery": (ControllerSettings(friction=0.02), None),
    "heavy footed": (ControllerSettings(min_normal_force=0.95), None),
    "weak": (ControllerSettings(), "ankle_torque = 15.0\nhip_torque = 90.0"),
}


@pytest.mark.parametrize("case", ADVERSE)
def test_limits_are_kept_in_adversity(robots, gaits, robot_name, case, tmp_path):
    """Whatever the state, a solved program's torques keep every limit on the motion that the robot then makes."""
    settings, weak = ADVERSE[case]
    robot = robots[robot_name]
    if weak is not None:
        text = robot.path.read_text().replace("[sole]", f"[limits]\n{weak}\n\n[sole]")
        (tmp_path / robot.path.name).write_text(text)
        (tmp_path / robot.description.urdf.name).write_text(robot.description.urdf.read_text())
        robot = load_robot(tmp_path / robot.path.name)
    gait = gaits[robot_name]
    controller = QpController(robot, gait, settings)
    active, solved = set(), 0
    for which, q, dq in adversarial_states(gait, 60, seed=7):
        command = controller.command(which, q, dq)
        if not command.solved:
            continue
        solved += 1
        w = robot.inverse_dynamics(q, dq, robot.forward_dynamics(q, dq, command.u))
        room = limits(robot, settings, command.u, w[:2], w[2])
        assert min(room.values()) > -LIMIT_TOLERANCE, room
        active |= {name for name, left in room.items() if left < ACTIVE}
        assert_close(command.force, w[:2], LIMIT_TOLERANCE, floor=robot.weight)
    assert solved >= 40  # most states admit torques that keep every limit
    expected = {"as designed": "fri", "slippery": "friction", "heavy footed": "unilateral", "weak": "torque"}
    assert expected[case] in active  # the case tests what it says


def test_unsolvable_state_is_relaxed(biped, reference_gait):
    """At a speed that throws the robot off the ground no torque keeps the contact; the controller says so."""
    controller = QpController(biped, reference_gait)
    q, dq = reference_gait.state_after_impact()
    last = controller.command(StepPhase.RISING, q, dq)
    assert last.solved
    flung = np.array([15.0, -15.0, 0.0, 0.0])
    command = controller.command(StepPhase.RISING, q, flung)
    assert not command.solved
    assert np.all(np.abs(command.u) <= biped.max_torque)
    assert (controller.ticks, controller.unsolved) == (2, 1)
    again = controller.command(StepPhase.RISING, q, dq)  # and recovers
    assert again.solved
    assert_close(again.u, last.u, CLOSED_FORM)


def test_a_command_owns_its_numbers(biped, reference_gait):
    """The program's arrays are reused; a command kept from an earlier tick must not change."""
    controller = QpController(biped, reference_gait)
    q, dq = reference_gait.state_after_impact()
    first = controller.command(StepPhase.RISING, q, dq)
    kept = first.u.copy()
    controller.command(StepPhase.RISING, q + 0.01, dq)
    assert np.array_equal(first.u, kept)


def test_same_state_same_command_whatever_came_before(biped, reference_gait):
    q, dq = reference_gait.state_after_impact()
    fresh = QpController(biped, reference_gait).command(StepPhase.RISING, q, dq)
    used = QpController(biped, reference_gait)
    for which, other_q, other_dq in adversarial_states(reference_gait, 10, seed=3):
        used.command(which, other_q, other_dq)
    assert_close(used.command(StepPhase.RISING, q, dq).u, fresh.u, CLOSED_FORM)
