"""Limits of the whole body: what a flat sole can carry, point by point, and how joints come to rest at their ends."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from whole_robots import whole

from frontal_biped.control.whole_body.limits import CONTACT, LOADED, MotionLimits, contact_rows
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.model import Stance
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import SpaceState

EXACT = 1e-12
"""Of the weight: products of the same few numbers."""

ALL_OF_IT = WholeBodySettings(sole_share=1.0)

BESIDE = 1e-6
"""How far outside an edge a point is [m]."""

ROBOTS = ("talos_full", "g1_bent", "simple_humanoid_bent")


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request):
    return whole(request.param)


@pytest.fixture(scope="module")
def talos():
    return whole("talos_full")


def sole_of(robot, side):
    return robot.free.soles[0 if side is Stance.LEFT else 1]


def wrench_of(points, forces):
    """(6,) about the origin, of forces at points."""
    return np.concatenate([forces.sum(axis=0), np.cross(points, forces).sum(axis=0)])


def kept(robot, side, settings=ALL_OF_IT):
    """The rows times a wrench, in weights."""
    rows = contact_rows(robot.free, side, settings) / robot.free.weight
    return lambda wrench: rows @ wrench


# ---------------------------------------------------------------------- centre of pressure
@pytest.mark.parametrize("side", Stance)
def test_forces_at_the_corners_of_the_sole(robot, side):
    """Any upward forces there keep the rows; one corner alone is on two edges, and the rows say so."""
    rows, corners = kept(robot, side), sole_of(robot, side).corners
    rng = np.random.default_rng(0)
    for corner in corners:
        value = rows(wrench_of(corner[None], np.array([[0.0, 0.0, robot.free.weight]])))
        assert value.min() > -EXACT
        assert np.sum(np.abs(value[4:8]) < EXACT) == 2
    for _ in range(100):
        forces = np.zeros((4, 3))
        forces[:, 2] = robot.free.weight * rng.exponential(size=4)
        assert rows(wrench_of(corners, forces)).min() > -EXACT


@pytest.mark.parametrize("side", Stance)
def test_a_force_beside_the_sole_is_refused(robot, side):
    """Just inside each edge it is not: outer and inner are on the right sides of the left and of the right foot."""
    rows, sole = kept(robot, side), sole_of(robot, side)
    x, y, _ = sole.corners.T
    middle = np.array([0.5 * (x.min() + x.max()), 0.5 * (y.min() + y.max()), 0.0])
    up = np.array([[0.0, 0.0, robot.free.weight]])
    edges = {
        "front": (0, x.max(), 1.0), "back": (0, x.min(), -1.0), "left": (1, y.max(), 1.0), "right": (1, y.min(), -1.0),
    }  # fmt: skip
    refused = set()
    for axis, at, outwards in edges.values():
        inside, outside = middle.copy(), middle.copy()
        inside[axis], outside[axis] = at - outwards * BESIDE, at + outwards * BESIDE
        assert rows(wrench_of(inside[None], up)).min() > 0.0
        value = rows(wrench_of(outside[None], up))
        assert np.sum(value < 0.0) == 1
        refused.add(int(np.argmin(value)))
    assert len(refused) == len(edges)


@pytest.mark.parametrize("side", Stance)
def test_a_share_of_the_sole_is_counted_from_the_ankle(robot, side):
    sole = sole_of(robot, side)
    up = np.array([[0.0, 0.0, robot.free.weight]])
    rows = kept(robot, side, WholeBodySettings(sole_share=0.5))
    for corner in 0.5 * sole.corners:
        assert rows(wrench_of((1.0 - BESIDE) * corner[None], up)).min() > -EXACT
        assert rows(wrench_of((1.0 + 1e-3) * corner[None], up)).min() < 0.0


# ---------------------------------------------------------------------- friction
def test_the_pyramid_lies_inside_the_cone(robot):
    """Its edges touch the cone, at 45 degrees."""
    settings = WholeBodySettings()
    rows = kept(robot, Stance.LEFT, settings)
    for angle in np.linspace(0.0, 2.0 * np.pi, 73):
        along = np.array([np.cos(angle), np.sin(angle)])
        force = np.array([0.0, 0.0, robot.free.weight, 0.0, 0.0, 0.0])
        force[:2] = settings.friction / np.sqrt(2.0) / np.abs(along).max() * force[2] * along
        assert rows(force).min() == pytest.approx(0.0, abs=EXACT)
        assert np.hypot(*force[:2]) <= settings.friction * force[2] * (1.0 + EXACT)
        force[:2] *= 1.0 + 1e-6
        assert rows(force).min() < 0.0


@pytest.mark.parametrize("turning", [1.0, -1.0])
@pytest.mark.parametrize("side", Stance)
def test_yaw_moment_is_one_that_friction_of_a_turning_sole_holds(robot, side, turning):
    """A sole that turns on the spot under an even pressure: Coulomb friction at every point, summed about its middle.

    The rows allow nine tenths of it and more, and no more than all.
    """
    settings = WholeBodySettings(sole_share=1.0, friction=0.6)
    sole, count = sole_of(robot, side), 200
    grid = (np.arange(count) + 0.5) / count - 0.5
    x, y = (part.ravel() for part in np.meshgrid(sole.length * grid, sole.width * grid))
    held = settings.friction * robot.free.weight * np.hypot(x, y).mean()
    rows = kept(robot, side, settings)
    wrench = np.array([0.0, 0.0, robot.free.weight, 0.0, 0.0, 0.0])
    middle = sole.corners.mean(axis=0)
    wrench[3:5] = robot.free.weight * middle[1], -robot.free.weight * middle[0]
    for share, allowed in ((0.9, True), (1.0 + 1e-3, False)):
        wrench[5] = turning * share * held
        assert (rows(wrench).min() >= 0.0) == allowed


def test_the_last_row_is_the_load(robot):
    rows = contact_rows(robot.free, Stance.LEFT, ALL_OF_IT)
    assert rows.shape == (CONTACT, 6)
    np.testing.assert_array_equal(rows[LOADED], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


# ---------------------------------------------------------------------- ranges and speeds
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_joints_under_their_largest_acceleration_keep_range_and_speed(talos, sense):
    """Driven as hard as the bounds allow, for long: each joint comes to rest at the margin, and never passes it."""
    settings, free = WholeBodySettings(), talos.free
    limits, state = MotionLimits(free, settings), SpaceState(free)
    n = len(free.joint_names)
    v = talos.still

    def flow(_, x):
        state.q, state.v = np.concatenate([free.posture[: BASE + 1], x[:n]]), np.concatenate([v[:BASE], x[n:]])
        bounds = limits.at(state)
        return np.concatenate([x[n:], bounds.upper if sense > 0.0 else bounds.lower])

    end = free.limits.upper - settings.range_margin if sense > 0.0 else free.limits.lower + settings.range_margin
    fastest = settings.speed_share * free.limits.velocity
    run = solve_ivp(flow, (0.0, 10.0), np.concatenate([talos.joints, np.zeros(n)]), max_step=0.01)
    positions, rates = run.y[:n], run.y[n:]
    assert np.max(sense * (positions - end[:, None])) < 1e-3 * settings.range_margin
    assert np.max(np.abs(rates) - fastest[:, None]) < 1e-3
    np.testing.assert_allclose(positions[:, -1], end, atol=1e-3)


def test_what_is_beyond_a_limit_is_brought_back(talos):
    """Outside its range or too fast, a joint must accelerate inwards; the bounds may then contradict each other."""
    settings, free = WholeBodySettings(), talos.free
    limits, state = MotionLimits(free, settings), SpaceState(free)
    state.q = np.concatenate([free.posture[: BASE + 1], free.limits.upper + 0.01])
    assert np.all(limits.at(state).upper < 0.0)
    state.q = np.concatenate([free.posture[: BASE + 1], free.limits.lower - 0.01])
    assert np.all(limits.at(state).lower > 0.0)
    state.q = free.posture
    state.v = np.concatenate([np.zeros(BASE), free.limits.velocity])
    assert np.all(limits.at(state).upper < 0.0)
