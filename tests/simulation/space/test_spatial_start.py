"""The start of a walk in space is the planar state, seen in the free robot."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped import load_gait, load_robot
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.catalogue import models_dir
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.space.start import start_in_space

ROBOTS = ("talos_full", "romeo", "g1", "simple_humanoid_classical")

EXACT = 1e-11
"""Of positions [m, rad], solved to 1e-12, and velocities of order one."""

DIFFERENCES = 1e-8
"""Of central differences with a step of 1e-6: rounding 1e-10, truncation 1e-12 times third derivatives."""


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request):
    biped = load_robot(request.param)
    gait = load_gait(models_dir() / f"{request.param}.gait.json")
    return FreeRobot(biped.robot), biped, gait.state_after_impact(), gait.step_width


@pytest.mark.parametrize("stance", list(Stance))
def test_feet_stand_and_roll_joints_are_the_planar_ones(robot, stance):
    """Roll joints whose axes point along X move exactly as in the plane, and nothing else does."""
    free, biped, planar, width = robot
    start = start_in_space(free, biped, planar, stance)
    model, data = free.model, free.model.createData()
    pin.forwardKinematics(model, data, *start)
    pin.updateFramePlacements(model, data)
    stands, swings = data.oMf[free.sole_frame(stance)], data.oMf[free.sole_frame(stance.other)]
    for sole, sign in ((stands, stance.sign), (swings, stance.other.sign)):
        np.testing.assert_allclose(sole.translation, [0.0, 0.5 * sign * width, 0.0], atol=EXACT)
        np.testing.assert_allclose(sole.rotation, np.eye(3), atol=EXACT)
    velocity = pin.getFrameVelocity(model, data, free.sole_frame(stance)).vector
    np.testing.assert_allclose(velocity, np.zeros(6), atol=EXACT)

    rolls = [free.joint_names.index(name) for name in biped.stance_map.joint_names]
    joints, rates = start.q[7:], start.v[6:]
    np.testing.assert_allclose(joints[rolls], biped.stance_map.positions_to_urdf(planar.q, stance), atol=EXACT)
    np.testing.assert_allclose(rates[rolls], biped.stance_map.velocities_to_urdf(planar.dq, stance), atol=EXACT)
    others = np.setdiff1d(np.arange(len(joints)), rolls)
    np.testing.assert_allclose(joints[others], free.posture[7:][others], atol=EXACT)
    np.testing.assert_allclose(rates[others], 0.0, atol=EXACT)


@pytest.mark.parametrize("stance", list(Stance))
def test_virtual_legs_make_the_turns_of_the_plane(stance):
    """Where roll axes point elsewhere, what is seen from the front is the planar state: by finite differences too."""
    biped = load_robot("g1_bent")
    planar = load_gait(models_dir() / "g1_bent.gait.json").state_after_impact()
    free, space = FreeRobot(biped.robot), SpaceState(FreeRobot(biped.robot))
    start = start_in_space(free, biped, planar, stance)
    seen = space.at(*start).frontal(stance)
    np.testing.assert_allclose(seen.q, planar.q, atol=EXACT)
    np.testing.assert_allclose(seen.dq, planar.dq, atol=EXACT)
    for side in Stance:
        np.testing.assert_allclose(space.feet[side].position[2], 0.0, atol=EXACT)
        np.testing.assert_allclose(space.feet[side].turning.angles, np.zeros(3), atol=EXACT)
    np.testing.assert_allclose(space.feet[stance].velocity, np.zeros(6), atol=EXACT)
    np.testing.assert_allclose(space.pelvis.angles[1:], 0.0, atol=EXACT)
    h, q = 1e-6, []
    for sign in (1.0, -1.0):
        state = space.at(pin.integrate(free.model, start.q, sign * h * start.v), start.v)
        q.append(state.frontal(stance).q.copy())
    np.testing.assert_allclose((q[0] - q[1]) / (2.0 * h), planar.dq, atol=DIFFERENCES)


def test_out_of_reach(robot):
    """Legs that spread by a radian and a half."""
    free, biped, planar, _ = robot
    with pytest.raises(SimulationError, match=r"joint '.*' would be at .* beyond its range"):
        start_in_space(free, biped, planar._replace(q=planar.q + np.array([0.0, 0.0, -1.5, 1.5])))
