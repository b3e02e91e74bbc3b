"""Every limit binds and holds in a run: closed loop at 1 kHz from a state off the gait."""

import dataclasses

import numpy as np
import pytest

from frontal_biped.control import ControllerSettings, JointLimits, QpController
from frontal_biped.control.torques.limits import WalkingLimits
from frontal_biped.gait.constraints import phase_limits
from frontal_biped.model import load_robot
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints import StepPhase

PERIOD = 1e-3  # [s]
HOLDS = 1e-6
"""How far a limit may be overstepped, relative to the weight (force) or the weight on 0.1 m (torque)."""

BINDS = 1e-4
"""Relative distance at which a limit counts as reached."""

BETWEEN_TICKS = 2e-3
"""Torques are held for a period, so a joint may pass its limit by about T dq / (rate of the barrier) [rad, share]."""


def run(controller, q, dq, ticks=120):
    """States and commands of the rising phase, torques held between ticks, Runge-Kutta of order 4."""
    robot, states = controller.biped, []

    def slope(x, u):
        return np.concatenate([x[4:], robot.forward_dynamics(x[:4], x[4:], u)])

    x = np.concatenate([q, dq])
    for _ in range(ticks):
        command = controller.command(StepPhase.RISING, x[:4], x[4:])
        states.append((x[:4], x[4:], command))
        u = command.u
        k1 = slope(x, u)
        k2 = slope(x + 0.5 * PERIOD * k1, u)
        k3 = slope(x + 0.5 * PERIOD * k2, u)
        k4 = slope(x + PERIOD * k3, u)
        x = x + PERIOD / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return states


def room(robot, settings, q, dq, command):
    """Room left to every limit on the motion the robot makes, relative; negative where overstepped."""
    w = robot.inverse_dynamics(q, dq, robot.forward_dynamics(q, dq, command.u))
    most = robot.max_torque if settings.max_torque is None else np.array(settings.max_torque)
    outer, inner = robot.sole
    lever = 0.1 * robot.weight
    return {
        "torque": float(np.min(most - np.abs(command.u))) / lever,
        "unilateral": w[1] / robot.weight - settings.min_normal_force,
        "friction": (settings.friction * w[1] - abs(w[0])) / robot.weight,
        "fri": min(w[2] - outer * w[1], inner * w[1] - w[2]) / lever,
    }


CASES = {
    "torque": {"max_torque": (9.0, 25.0, 25.0, 9.0)},
    "friction": {"friction": 0.01},
    "unilateral": {"min_normal_force": 0.96},
    "fri": {},
}


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
@pytest.mark.parametrize("limit", CASES)
def test_limit_binds_and_holds_in_a_run(biped, level_gait, limit, outputs):
    settings = ControllerSettings(frequency=100.0, outputs=outputs, **CASES[limit])
    controller = QpController(biped, level_gait, settings)
    q, dq = level_gait.state_after_impact()
    states = run(controller, q + np.array([0.0, 0.02, -0.02, 0.02]), dq)
    left = [room(biped, settings, *state) for state in states if state[2].solved]
    assert len(left) == len(states)  # no tick without torques that keep every limit
    assert min(min(each.values()) for each in left) > -HOLDS
    assert min(each[limit] for each in left) < BINDS


@pytest.fixture(scope="module")
def tight(biped, tmp_path_factory):
    """The robot with ankles that the gait drives to the end of their range and past their speed."""
    folder = tmp_path_factory.mktemp("tight")
    urdf = biped.path.parent / biped.description.urdf
    text = urdf.read_text().replace('lower="-1.2" upper="1.2" effort="150" velocity="10"', "ANKLE")
    text = text.replace("ANKLE", 'lower="-0.3" upper="0.3" effort="150" velocity="1.5"')
    assert "-0.3" in text
    (folder / urdf.name).write_text(text)
    (folder / biped.path.name).write_text(biped.path.read_text())
    return load_robot(folder / biped.path.name)


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
def test_joints_stay_inside_their_range_and_speed(tight, reference_gait, outputs):
    q, dq = reference_gait.state_after_impact()
    free = run(QpController(tight, reference_gait, ControllerSettings(frequency=100.0, outputs=outputs)), q, dq, 300)
    controller = QpController(
        tight, reference_gait, ControllerSettings(frequency=100.0, joint_rate=50.0, outputs=outputs)
    )
    kept = run(controller, q, dq, 300)
    assert controller.unsolved == 0

    def excess(states):
        q, dq = np.array([state[0] for state in states]), np.array([state[1] for state in states])
        beyond = np.maximum(tight.joint_lower - q, q - tight.joint_upper).max()
        return beyond, (np.abs(dq) / tight.joint_max_velocity).max() - 1.0

    assert min(excess(free)) > 0.02  # without the bounds range and speed are overstepped
    beyond, faster = excess(kept)
    assert -BETWEEN_TICKS < max(beyond, faster) < BETWEEN_TICKS  # with them they are reached, and kept
    bounds = JointLimits(tight.joint_lower, tight.joint_upper, tight.joint_max_velocity, 50.0)
    binding = 0
    for q, dq, command in kept:
        lower, upper = bounds.bounds(State(q, dq))
        margin = min((command.ddq - lower).min(), (upper - command.ddq).min())
        assert margin > -1e-5  # 10 rad/s^2 times the accuracy of the program
        binding += margin < 1e-3
    assert binding > 10


def test_inside_the_ranges_some_acceleration_meets_every_bound(biped):
    """The rate of the speed's barrier is twice that of the range's for this: bounds never cross."""
    limits = JointLimits(biped.joint_lower, biped.joint_upper, biped.joint_max_velocity, 100.0)
    rng = np.random.default_rng(0)
    for _ in range(500):
        q = rng.uniform(biped.joint_lower, biped.joint_upper)
        dq = rng.uniform(-1.0, 1.0, 4) * biped.joint_max_velocity
        lower, upper = limits.bounds(State(q, dq))
        assert np.all(upper - lower > -1e-9)
        for ddq in (lower, upper, 0.5 * (lower + upper)):
            assert limits.keeps(State(q, dq), ddq + 1e-9 * np.sign(0.5 * (lower + upper) - ddq))
        assert not limits.keeps(State(q, dq), upper + 1e-3)
        assert not limits.keeps(State(q, dq), lower - 1e-3)


def test_defaults_have_no_joint_bounds(biped, level_gait):
    assert QpController(biped, level_gait).program.qp.limits.joints is None
    assert dataclasses.replace(ControllerSettings(), joint_rate=50.0).joint_rate == 50.0


def test_the_program_keeps_what_the_gait_was_designed_for(biped, level_gait):
    """Its limits are C06 as design and report have it (`gait.constraints`), the FRI up to the end of the sole."""
    specification = dataclasses.replace(level_gait.specification, fri_margin=0.0, max_torque=(20.0, 40.0, 50.0, 15.0))
    gait = dataclasses.replace(level_gait, specification=specification)
    limits = WalkingLimits.of(biped, ControllerSettings.for_gait(gait)).contact
    rng = np.random.default_rng(7)
    n = 4000
    F_v = biped.weight * rng.uniform(0.02, 1.5, n)
    F_h = rng.uniform(-1.5, 1.5, n) * specification.friction * F_v
    p_fri = rng.uniform(-1.5, 1.5, n) * biped.sole[1]
    u = rng.uniform(-1.1, 1.1, (n, 4)) * np.array(specification.max_torque)
    forces = np.array([F_h, F_v, p_fri * F_v, *u.T])
    vertical, friction, fri, torques = phase_limits(biped, specification, forces, p_fri, "rising")
    inside = np.ones(n, dtype=bool)
    for constraint in (vertical, friction, fri, *torques):
        for bound, sign in constraint.sides():
            inside &= sign * (constraint.values - bound) >= 0.0
    assert 0.05 * n < inside.sum() < 0.95 * n  # both answers occur
    assert [limits.keeps(column) for column in forces.T.tolist()] == inside.tolist()


def test_bounds_joint_by_joint_are_the_same():
    """Digit by digit, inside and far outside of ranges, with and without limits on a side."""
    rng = np.random.default_rng(2)
    lower, upper = np.array([-np.inf, -0.5, -1.0, -np.inf]), np.array([0.4, np.inf, 1.0, np.inf])
    limits = JointLimits(lower, upper, np.array([3.0, np.inf, 5.0, np.inf]), 60.0)
    for size in (0.1, 1.0, 100.0):
        state = State(size * rng.normal(size=4), 10.0 * size * rng.normal(size=4))
        assert np.array_equal(np.array(limits.bounds_of_joints(state)).T, np.array(limits.bounds(state)))
