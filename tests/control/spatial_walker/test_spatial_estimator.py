"""The estimator of the robot in space, on motions whose stance foot is at rest by construction."""

import numpy as np
import pinocchio as pin
import pytest
from random_states import assert_close
from whole_robots import whole

from frontal_biped.control.spatial_walker.estimator import SpatialEstimator, SpatialEstimatorSettings, exact
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.model import Stance
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.landing import land
from frontal_biped.model.space.virtual_legs import SpaceState

H = 1e-3  # [s]

EXACT = 1e-9
"""Positions and rates from the same kinematics by another way [m, rad, m/s, rad/s]."""

FOLLOWED = 1e-4
"""Rates of a motion of 1 rad/s at 0.5 Hz, read exactly and all but taken as they come [rad/s, m/s]."""

SMOOTHED = 2e-2
"""The same with rates from encoders alone, in the filter's own time [rad/s]."""

AHEAD = 1e-6
"""Of positions three periods ahead: turning by steps of 1 ms against steps of a thousandth of that."""


@pytest.fixture(scope="module", params=["talos_full", "g1_bent"])
def robot(request):
    return whole(request.param)


class Swaying:
    """Joints swing about the posture; the base is where the stance foot at rest has it."""

    def __init__(self, robot, stance, seed=0):
        self.free, self.stance = robot.free, stance
        self.data, self.space = robot.free.model.createData(), SpaceState(robot.free)
        rng, n = np.random.default_rng(seed), len(robot.joints)
        self.size, self.phase = 0.3 * rng.uniform(-1.0, 1.0, n), rng.uniform(0.0, 6.0, n)
        model, frame = self.free.model, self.free.sole_frame(stance)
        pin.forwardKinematics(model, self.data, self.free.posture)
        self.foot = pin.updateFramePlacement(model, self.data, frame).copy()
        self.foot.translation = np.array([0.3, self.foot.translation[1], 0.0])

    def at(self, t):
        """(q, v): the base by the placement of the foot, its velocity by differences of that."""
        q, v = self._placed(t), np.zeros(self.free.model.nv)
        before, after = self._placed(t - 1e-5), self._placed(t + 1e-5)
        v[:] = pin.difference(self.free.model, before, after) / 2e-5
        return q, v

    def _placed(self, t):
        model, frame = self.free.model, self.free.sole_frame(self.stance)
        q = self.free.posture.copy()
        q[BASE + 1 :] += self.size * np.sin(3.0 * t + self.phase)
        pin.forwardKinematics(model, self.data, q)
        sole = pin.updateFramePlacement(model, self.data, frame)
        q[:7] = pin.SE3ToXYZQUAT(self.foot * sole.inverse() * self.data.oMi[1])
        return q


def reading(q, v, t=0.0, rates=True):
    contact = (True, True)
    R = pin.Quaternion(q[6], q[3], q[4], q[5]).matrix()
    return SpatialReading(t, q[BASE + 1 :], v[BASE:] if rates else None, R, v[3:BASE], contact)


# ---------------------------------------------------------------------- standing
@pytest.mark.parametrize("stance", Stance)
@pytest.mark.parametrize(("rates", "within"), [(True, FOLLOWED), (False, SMOOTHED)])
def test_exact_sensors(robot, stance, rates, within):
    """From encoders and the inertial unit alone: where the base is and how fast, as the foot at rest has it."""
    motion = Swaying(robot, stance)
    settings = exact(SpatialEstimatorSettings()) if rates else SpatialEstimatorSettings()
    estimator = SpatialEstimator(robot.free, H, settings)
    q, v = motion.at(0.0)
    estimator.reset(stance, q, v)
    np.testing.assert_allclose(estimator.foothold, motion.foot.translation, atol=EXACT)
    dv = np.zeros(robot.free.model.nv)
    errors = []
    for k in range(1, 401):
        before = v
        q, v = motion.at(k * H)
        dv = (v - before) / H
        estimator.predict(dv)
        estimator.correct(reading(q, v, k * H, rates))
        errors.append(
            (
                np.abs(pin.difference(robot.free.model, q, estimator.q)).max(),
                np.abs(estimator.v - v).max(),
                np.abs(estimator.sole(stance) - motion.foot.translation).max(),
            )
        )
    position, rate, foot = np.max(errors, axis=0)
    assert position < 0.1 * within
    assert rate < within
    assert foot < EXACT


def test_wrong_rates_are_forgotten(robot):
    """A tenth of a radian a second off at first, as after a landing nobody foresaw, and no accelerations told."""
    motion = Swaying(robot, Stance.LEFT)
    estimator = SpatialEstimator(robot.free, H)
    q, v = motion.at(0.0)
    off = 0.1 * np.random.default_rng(1).normal(size=robot.free.model.nv)
    estimator.reset(Stance.LEFT, q, v + off)
    for k in range(1, 150):
        q, v = motion.at(k * H)
        estimator.predict(np.zeros(robot.free.model.nv))
        estimator.correct(reading(q, v))
    assert np.abs(pin.difference(robot.free.model, q, estimator.q)).max() < 1e-3
    assert np.abs(estimator.v - v).max() < SMOOTHED


def test_clearance_is_the_lowest_corner(robot):
    """Of the swing foot above the stance foot, from placements by themselves."""
    motion, free = Swaying(robot, Stance.LEFT, seed=2), robot.free
    estimator = SpatialEstimator(free, H)
    q, v = motion.at(0.2)
    estimator.reset(Stance.LEFT, q, v)
    estimator.correct(reading(q, v))
    data = free.model.createData()
    pin.framesForwardKinematics(free.model, data, q)
    swing = data.oMf[free.sole_frame(Stance.RIGHT)]
    lowest = min((swing * corner)[2] for corner in free.soles.right.corners)
    assert estimator.clearance(Stance.RIGHT) == pytest.approx(lowest - motion.foot.translation[2], abs=EXACT)


# ---------------------------------------------------------------------- ahead
def test_over_the_delay_the_motion_goes_on(robot):
    """Accelerations on their way, each for a period: against the same integrated in a thousand steps each."""
    motion, model = Swaying(robot, Stance.RIGHT, seed=3), robot.free.model
    estimator, space = SpatialEstimator(robot.free, H), SpaceState(robot.free)
    q, v = motion.at(0.1)
    estimator.reset(Stance.RIGHT, q, v)
    rng, sent = np.random.default_rng(4), []
    fine_q, fine_v = q.copy(), v.copy()
    for _ in range(3):
        foot = space.at(fine_q, fine_v).feet[Stance.RIGHT]
        joints = 20.0 * rng.normal(size=model.nv - BASE)
        base = np.linalg.solve(foot.J[:, :BASE], -foot.drift - foot.J[:, BASE:] @ joints)
        sent.append(np.concatenate([base, joints]))
        for _ in range(1000):
            fine_q = pin.integrate(model, fine_q, 1e-3 * H * (fine_v + 0.5e-3 * H * sent[-1]))
            fine_v = fine_v + 1e-3 * H * sent[-1]
    there_q, there_v = estimator.ahead(sent)
    assert np.abs(pin.difference(model, fine_q, there_q)).max() < AHEAD
    assert np.abs(there_v - fine_v).max() < 1e3 * AHEAD  # the foot is put to rest again
    foot = space.at(there_q, there_v).feet[Stance.RIGHT]
    np.testing.assert_allclose(foot.position, motion.foot.translation, atol=EXACT)
    np.testing.assert_allclose(foot.velocity[:3], 0.0, atol=EXACT)
    assert np.array_equal(estimator.q, q) and np.array_equal(estimator.v, v)  # the present is kept


def test_nothing_on_its_way_is_the_present(robot):
    estimator = SpatialEstimator(robot.free, H)
    q, v = estimator.ahead([])
    assert q is estimator.q and v is estimator.v


# ---------------------------------------------------------------------- landing
@pytest.mark.parametrize("stance", Stance)
def test_velocities_jump_as_a_rigid_landing_has_it(robot, stance):
    """The foot that swings comes to rest flat: the impulse in generalised coordinates, by `land` in another way."""
    motion = Swaying(robot, stance, seed=5)
    estimator, space = SpatialEstimator(robot.free, H), SpaceState(robot.free)
    q, v = motion.at(0.3)
    estimator.reset(stance, q, v)
    swing = stance.other
    expected = land(space.at(q, v), swing)
    where = space.feet[swing].position.copy()
    estimator.error[:] = 1.0
    estimator.land()
    assert_close(estimator.v, expected.v_plus, 1e-8)
    np.testing.assert_allclose(estimator.foothold[:2], where[:2], atol=EXACT)
    assert estimator.foothold[2] == 0.0  # the ground is taken for level
    assert np.array_equal(estimator.error, np.zeros_like(v))  # of the other foot's own last step
    foot = space.at(estimator.q, estimator.v).feet[swing]
    np.testing.assert_allclose(foot.position[2], 0.0, atol=EXACT)
    estimator.land()
    assert np.array_equal(estimator.error, np.ones_like(v))
