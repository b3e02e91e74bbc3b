"""The whole robot in MuJoCo: momentum, standing, friction, pushes, and motors that keep their limits."""

import numpy as np
import pinocchio as pin
import pytest
from standing import Stander

from frontal_biped import load_robot
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.errors import SpatialErrors
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.hybrid_system import EventKind
from frontal_biped.simulation.mujoco.space_engine import TOPPLED_OVER, SpaceEngine
from frontal_biped.simulation.mujoco.space_robot import SPEED_BAND, SpaceRobot
from frontal_biped.simulation.mujoco.spec import ContactSettings
from frontal_biped.simulation.mujoco.walk import DIVERGED
from frontal_biped.simulation.space.pushes import LinkForce, SpatialPush, SpatialPushForces

mujoco = pytest.importorskip("mujoco")

STEP = 5e-4  # of the physics [s]

HEIGHT = 2.0  # where the feet touch nothing [m]

ROUNDING = 1e-12
"""Of a change of coordinates."""

OTHERS = 0.02
"""Share of a joint's speed limit that the motion of all other, powerless joints may add to it."""

FIRST_ORDER = 5e-3
"""Relative error of momentum in a tenth of a second with steps of `STEP`: the integrator is of first order."""


@pytest.fixture(scope="module")
def free():
    return FreeRobot(load_robot("talos_full").robot)


@pytest.fixture
def robot(free):
    robot = SpaceRobot(free)
    robot.place(free.posture, np.zeros(free.model.nv))
    return robot


def in_the_air(free, generator=None):
    q = free.posture.copy()
    q[2] += HEIGHT
    v = np.zeros(free.model.nv) if generator is None else generator.uniform(-0.5, 0.5, free.model.nv)
    return q, v


def momentum(free, robot):
    """(6,) linear, and angular about the centre of mass, by Pinocchio; world axes."""
    data = free.model.createData()
    return pin.computeCentroidalMomentum(free.model, data, *robot.state()).vector.copy()


def stand(robot, seconds, pushes=(), stander=None, seen=None):
    """Stand under a `Stander`, in control periods of two physics steps."""
    stander = stander or Stander(robot.free)
    forces = SpatialPushForces(pushes)
    for tick in range(round(seconds / (2.0 * STEP))):
        reading = _reading(robot, tick)
        robot.run(stander.torques(reading), 2, forces.at(2.0 * STEP * tick))
        if seen is not None:
            seen(robot)


def _reading(robot, tick):
    class Reading:
        joint_positions, joint_velocities = robot.joint_positions, robot.joint_velocities

    return Reading


# ---------------------------------------------------------------------- coordinates
def test_a_state_comes_back_as_it_was_given(free):
    robot, generator = SpaceRobot(free), np.random.default_rng(1)
    for _ in range(5):
        q = pin.integrate(free.model, free.posture, generator.uniform(-0.3, 0.3, free.model.nv))
        v = generator.uniform(-2.0, 2.0, free.model.nv)
        robot.place(q, v)
        np.testing.assert_allclose(robot.state().q, q, atol=ROUNDING)
        np.testing.assert_allclose(robot.state().v, v, atol=ROUNDING)


def test_centre_of_mass_and_soles_are_those_of_pinocchio(free):
    robot, generator, data = SpaceRobot(free), np.random.default_rng(2), free.model.createData()
    q = pin.integrate(free.model, free.posture, generator.uniform(-0.3, 0.3, free.model.nv))
    v = generator.uniform(-2.0, 2.0, free.model.nv)
    robot.place(q, v)
    com, velocity = robot.com()
    np.testing.assert_allclose(com, pin.centerOfMass(free.model, data, q, v), atol=1e-10)
    np.testing.assert_allclose(velocity, data.vcom[0], atol=1e-10)
    pin.framesForwardKinematics(free.model, data, q)
    for side in Stance:
        place, pose = data.oMf[free.sole_frame(side)], robot.sole(side)
        np.testing.assert_allclose(pose.position, place.translation, atol=ROUNDING)
        np.testing.assert_allclose(pose.rotation, place.rotation, atol=ROUNDING)


def test_velocity_is_the_rate_of_the_configuration(free):
    """In the air, with no torque: the way of one step, by Pinocchio, is the velocity after it times the step."""
    robot = SpaceRobot(free)
    robot.place(*in_the_air(free, np.random.default_rng(3)))
    before = robot.state().q
    robot.run(np.zeros(len(free.joint_names)), 1)
    after = robot.state()
    way = pin.difference(free.model, before, after.q) / STEP
    np.testing.assert_allclose(way, after.v, atol=1e-2 * np.abs(after.v).max())


# ---------------------------------------------------------------------- momentum
def test_free_fall(free):
    """Whatever the joints do, the momentum of the whole changes by the weight alone."""
    robot, generator = SpaceRobot(free), np.random.default_rng(4)
    robot.place(*in_the_air(free, generator))
    before, tau = momentum(free, robot), generator.uniform(-2.0, 2.0, len(free.joint_names))
    seconds = 0.1
    robot.run(tau, round(seconds / STEP))
    expected = before + np.array([0.0, 0.0, -free.weight * seconds, 0.0, 0.0, 0.0])
    size = max(free.weight * seconds, np.abs(before).max())
    np.testing.assert_allclose(momentum(free, robot), expected, atol=FIRST_ORDER * size)


@pytest.mark.parametrize("link", ["", "torso_2_link", "arm_right_7_link", "leg_left_3_link"])
def test_a_push_gives_its_impulse(free, link):
    """Two falls, one pushed: linear momentum differs by the impulse, angular by arm times impulse."""
    point, impulse, duration = (0.05, -0.02, 0.1), np.array([3.0, -4.0, 1.0]), 0.01
    push = SpatialPush(0.0, duration, tuple(impulse), link, point, profile="half-sine")
    found = []
    for pushes in ((), (push,)):
        robot, forces = SpaceRobot(free), SpatialPushForces(pushes)
        robot.place(*in_the_air(free))
        arm = _arm(free, robot, link, point)
        for tick in range(round(duration / STEP)):
            robot.run(np.zeros(len(free.joint_names)), 1, forces.at(tick * STEP))
        found.append(momentum(free, robot))
    change = found[1] - found[0]
    # a half-sine sampled twenty times, and an arm that moves while it is pushed
    np.testing.assert_allclose(change[:3], impulse, atol=0.01 * np.linalg.norm(impulse))
    np.testing.assert_allclose(change[3:], np.cross(arm, impulse), atol=0.05 * np.linalg.norm(impulse))


def _arm(free, robot, link, point):
    """From the centre of mass to a point of a link, by Pinocchio [m]."""
    data = free.model.createData()
    pin.framesForwardKinematics(free.model, data, robot.state().q)
    place = data.oMf[free.model.getFrameId(link)] if link else data.oMi[1]
    return place.act(np.array(point)) - robot.com()[0]


def test_unknown_link_is_refused(robot):
    with pytest.raises(SimulationError, match=r"torso_3_link.*did you mean 'torso_[12]_link'"):
        robot.run(np.zeros(30), 1, [LinkForce(np.ones(3), "torso_3_link", np.zeros(3))])


# ---------------------------------------------------------------------- contact
@pytest.fixture(scope="module")
def standing(free):
    """A robot that has come to rest on both feet."""
    robot = SpaceRobot(free)
    robot.place(free.posture, np.zeros(free.model.nv))
    stand(robot, 1.0)
    return robot


def test_standing_feet_carry_the_weight(free, standing):
    wrenches = standing.wrenches()
    assert standing.contact == (True, True)
    total = wrenches.sum(axis=0)
    np.testing.assert_allclose(total[:3], [0.0, 0.0, free.weight], atol=1e-3 * free.weight)
    # moments of both soles about the centre of mass balance
    com, _ = standing.com()
    arms = [standing.sole(side).position - com for side in Stance]
    moment = sum(wrench[3:] + np.cross(arm, wrench[:3]) for arm, wrench in zip(arms, wrenches, strict=True))
    np.testing.assert_allclose(moment, np.zeros(3), atol=1e-3 * free.weight)
    # and each foot is pressed inside its own sole
    for sole, wrench in zip(free.soles, wrenches, strict=True):
        assert -sole.back < -wrench[4] / wrench[2] < sole.front
        assert abs(wrench[3] / wrench[2]) < max(sole.inner, sole.outer)


def test_wrenches_move_the_robot(free, robot):
    """Newton's law in every step of a disturbed stand: momentum by Pinocchio against forces by MuJoCo."""
    stander = Stander(free)
    push = SpatialPush(0.02, 0.1, (8.0, 3.0, 0.0), "torso_2_link")
    forces, worst = SpatialPushForces([push]), 0.0
    for tick in range(300):
        pushes, before = forces.at(tick * STEP), momentum(free, robot)
        robot.run(stander.torques(_reading(robot, tick)), 1, pushes)
        acting = robot.wrenches()[:, :3].sum(axis=0) - [0.0, 0.0, free.weight]
        acting = acting + sum((each.force for each in pushes), np.zeros(3))
        change = (momentum(free, robot)[:3] - before[:3]) / STEP
        worst = max(worst, np.abs(change - acting).max())
    assert worst < FIRST_ORDER * free.weight


@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_forces_stay_in_the_friction_cone_and_reach_it(free, friction):
    """A steady horizontal pull on both shins: below friction the feet stay, above it they slide at friction."""
    held = np.inf
    for share, slides in ((0.7, False), (1.3, True)):
        robot = SpaceRobot(free, contact=ContactSettings(friction=friction))
        robot.place(free.posture, np.zeros(free.model.nv))
        stand(robot, 0.3)
        before, pull = robot.sole(Stance.LEFT).position, 0.5 * share * friction * free.weight
        stander, ratios = Stander(free), []
        for tick in range(100):
            # at the height of the ankles: they slide and do not tip
            pulls = [LinkForce(np.array([0.0, pull, 0.0]), _foot(side), np.zeros(3)) for side in Stance]
            robot.run(stander.torques(_reading(robot, tick)), 2, pulls)
            for wrench in robot.wrenches():
                if wrench[2] > 0.0:
                    ratios.append(np.hypot(*wrench[:2]) / wrench[2])
        assert max(ratios) < friction * (1.0 + 1e-6)
        slid = np.linalg.norm(robot.sole(Stance.LEFT).position - before)
        if slides:
            assert np.median(ratios) > 0.9 * friction
            assert slid > 10.0 * held
        else:
            held = slid
            assert held < 2e-3


def test_corners_hold_yaw(free):
    """Four corners with friction resist a couple about Z of up to friction times their distance; a point would not."""
    friction = 0.5
    sole = free.soles.left
    arm = 0.5 * np.hypot(sole.length, sole.width)
    holds = friction * free.weight * arm  # both feet together, each about its own middle
    turned = {}
    for share in (0.5, 2.0):
        robot = SpaceRobot(free, contact=ContactSettings(friction=friction))
        robot.place(free.posture, np.zeros(free.model.nv))
        stand(robot, 0.3)
        stander = Stander(free)
        couple = 0.5 * share * holds  # on each foot
        for tick in range(100):
            pair = [
                LinkForce(np.array([0.0, sign * couple / 0.2, 0.0]), _foot(side), np.array([sign * 0.1, 0.0, 0.0]))
                for side in Stance
                for sign in (1.0, -1.0)
            ]
            robot.run(stander.torques(_reading(robot, tick)), 2, pair)
        R = robot.sole(Stance.LEFT).rotation
        turned[share] = abs(np.arctan2(R[1, 0], R[0, 0]))
    assert turned[0.5] < 2e-3
    assert turned[2.0] > 10.0 * turned[0.5]


def _foot(side):
    return f"leg_{side.value}_6_link"


# ---------------------------------------------------------------------- motors
def test_torques_are_cut_at_the_effort(free, robot):
    robot.place(*in_the_air(free))
    robot.run(np.full(30, 1e6), 1)
    np.testing.assert_allclose(robot.torques(), free.limits.effort)
    robot.run(np.full(30, -1e6), 1)
    assert np.all(np.abs(robot.torques()) <= free.limits.effort)


@pytest.mark.parametrize("joint", ["leg_left_4_joint", "arm_left_4_joint", "head_2_joint"])
def test_no_motor_drives_beyond_its_speed(free, joint):
    """Full torque from rest: the joint comes up to its speed, does not pass it, and does not chatter there."""
    index, limits = free.joint_names.index(joint), free.limits
    unlimited = free.limits.upper[index] + 100.0
    robot = SpaceRobot(free)
    robot.model.jnt_range[robot.model.joint(joint).id] = [-unlimited, unlimited]
    robot.place(*in_the_air(free))
    tau = np.zeros(30)
    tau[index] = limits.effort[index]
    speeds, torques = [], []
    for _ in range(300):
        robot.run(tau, 1)
        speeds.append(robot.joint_velocities[index])
        torques.append(robot.torques()[index])
    assert max(speeds) <= limits.velocity[index] * (1.0 + OTHERS)
    assert max(speeds) > (1.0 - SPEED_BAND) * limits.velocity[index]
    reached = int(np.argmax(np.array(speeds) > (1.0 - SPEED_BAND) * limits.velocity[index]))
    assert torques[0] == pytest.approx(limits.effort[index])
    # a smooth decline: neighbours differ by less than half of the whole torque
    assert np.abs(np.diff(torques[reached:])).max() < 0.5 * limits.effort[index]
    # braking is not weakened
    robot.run(-tau, 1)
    assert robot.torques()[index] == pytest.approx(-limits.effort[index])


def test_joints_stop_at_the_ends_of_their_range(free, robot):
    """Driven into the end with full torque, a joint gives way by a degree or two as it arrives and then stays."""
    for joint in ("leg_left_4_joint", "arm_right_4_joint"):
        index = free.joint_names.index(joint)
        robot.place(*in_the_air(free))
        tau = np.zeros(30)
        tau[index] = free.limits.effort[index]
        beyond = []
        for _ in range(600):
            robot.run(tau, 2)
            beyond.append(robot.joint_positions[index] - free.limits.upper[index])
        assert 0.0 < max(beyond) < np.radians(2.5), joint
        arrived = int(np.argmax(beyond))
        assert 0.0 < np.median(beyond[arrived : arrived + 100]) < np.radians(0.2), joint


# ---------------------------------------------------------------------- falls, ground, errors
def engine_at(free, q):
    engine = SpaceEngine(free, 2.0 * STEP)
    engine.place(q, np.zeros(free.model.nv))
    return engine.advance(0.0, 2.0 * STEP, np.zeros(30), SpatialPushForces(())).fell


def test_falls_are_told(free):
    assert engine_at(free, free.posture) is None
    low, tilted = free.posture.copy(), free.posture.copy()
    low[2] -= 0.5
    tilted[2] += HEIGHT
    tilted[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, np.radians(61.0), 0.0)).coeffs()
    assert engine_at(free, low) is EventKind.COLLAPSED
    assert engine_at(free, tilted) == TOPPLED_OVER
    tilted[3:7] = pin.Quaternion(pin.rpy.rpyToMatrix(0.0, np.radians(59.0), 0.0)).coeffs()
    assert engine_at(free, tilted) is None
    edge = free.posture.copy()
    edge[7 + free.joint_names.index("leg_left_6_joint")] += 0.52  # rad; the inner edge is 4 cm below the ground then
    assert engine_at(free, edge) is EventKind.EDGE_LANDING


def test_a_state_that_blows_up_is_a_fall(free):
    engine = SpaceEngine(free, 2.0 * STEP)
    engine.place(*in_the_air(free))
    engine.data.qvel[10] = 3e4
    assert engine.advance(0.0, 2.0 * STEP, np.zeros(30), SpatialPushForces(())).fell == DIVERGED


def test_ground_rises_when_the_foot_has_cleared_it(free):
    """A floor never hits a foot from below."""
    engine, rise = SpaceEngine(free, 2.0 * STEP), 0.01
    engine.place(free.posture, np.zeros(free.model.nv))
    engine.raise_ground(Stance.RIGHT, rise)
    engine.advance(0.0, 2.0 * STEP, np.zeros(30), SpatialPushForces(()))
    assert engine.ground(Stance.RIGHT) == 0.0
    lifted = free.posture.copy()
    lifted[2] += 2.0 * rise
    engine.place(lifted, np.zeros(free.model.nv))
    engine.raise_ground(Stance.RIGHT, rise)
    engine.advance(0.0, 2.0 * STEP, np.zeros(30), SpatialPushForces(()))
    assert engine.ground(Stance.RIGHT) == rise
    assert engine.ground(Stance.LEFT) == 0.0
    engine.place(free.posture, np.zeros(free.model.nv))
    assert engine.ground(Stance.RIGHT) == 0.0


def test_physics_step_must_divide_the_period(free):
    with pytest.raises(SimulationError, match="does not divide"):
        SpaceEngine(free, 1e-3, contact=ContactSettings(timestep=3e-4))


def test_errors_change_what_they_say(free):
    bodies = 1 + len(free.joint_names)
    errors = SpatialErrors.draw(np.random.default_rng(0), bodies, mass=0.1, com=0.01, inertia=0.1)
    exact, wrong = SpaceRobot(free), SpaceRobot(free, errors)
    masses = np.array([inertia.mass for inertia in free.model.inertias[1:]])
    assert wrong.model.body_mass.sum() == pytest.approx(masses @ errors.mass)
    # the centre of mass from Pinocchio, with the errors put into its bodies
    model = free.model.copy()
    for i, inertia in enumerate(free.model.inertias[1:]):
        model.inertias[i + 1] = pin.Inertia(
            inertia.mass * errors.mass[i], inertia.lever + errors.com[i], inertia.inertia * errors.inertia[i]
        )
    wrong.place(free.posture, np.zeros(free.model.nv))
    exact.place(free.posture, np.zeros(free.model.nv))
    data = model.createData()
    np.testing.assert_allclose(wrong.com()[0], pin.centerOfMass(model, data, free.posture), atol=1e-10)
    assert np.linalg.norm(wrong.com()[0] - exact.com()[0]) > 1e-4
    # and their inertias: kinetic energy at random velocities
    v = np.random.default_rng(1).uniform(-1.0, 1.0, model.nv)
    wrong.place(free.posture, v)
    product = np.zeros(model.nv)
    mujoco.mj_mulM(wrong.model, wrong.data, product, wrong.data.qvel)
    energy = pin.computeKineticEnergy(model, data, free.posture, v)  # rotors included
    assert 0.5 * product @ wrong.data.qvel == pytest.approx(energy, rel=1e-9)
    with pytest.raises(SimulationError, match="bodies"):
        SpaceRobot(free, SpatialErrors.none(3))
