"""Arrays for Pinocchio and MuJoCo: there and back, and MuJoCo itself agrees where every link is and how it moves."""

import numpy as np
import pinocchio as pin
import pytest
from urdf_in_mujoco import mujoco_model

from frontal_biped.model import load_robot
from frontal_biped.model.space.joint_arrays import JointArrays, from_mujoco, mujoco_joint_names, to_mujoco

ROUNDING = 1e-12
"""Of sums of a few products, and of lengths and speeds of a few metres and radians [m, m/s, rad/s]."""

INERTIAL = """<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"""

CONTINUOUS = f"""<robot name="wheel">
<link name="base">{INERTIAL}</link><link name="b">{INERTIAL}</link><link name="a">{INERTIAL}</link>
<link name="tip"/>
<joint name="z_wheel" type="continuous"><parent link="base"/><child link="b"/><axis xyz="0 1 0"/></joint>
<joint name="fixed" type="fixed"><parent link="b"/><child link="tip"/></joint>
<joint name="a_slide" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


class Wheel:
    """As much of a `Robot` as conventions ask for: with a joint whose position has two numbers in Pinocchio."""

    urdf_text = CONTINUOUS
    model = pin.buildModelFromXML(CONTINUOUS, pin.JointModelFreeFlyer())
    joint_names = tuple(model.names[2:])


def random_arrays(robot, generator, count=20):
    model = robot.model
    low, high = -np.ones(model.nq), np.ones(model.nq)
    q = np.array([pin.randomConfiguration(model, low, high) for _ in range(count)])
    v = generator.normal(size=(count, model.nv))
    return JointArrays(q, v, generator.normal(size=(count, model.nv - 6)), tuple(robot.joint_names))


@pytest.mark.parametrize("name", ["talos_full", "g1", "romeo", "simple_humanoid_classical", "wheel"])
def test_there_and_back(name):
    robot = Wheel() if name == "wheel" else load_robot(name).robot
    pin.seed(1)
    ours = random_arrays(robot, np.random.default_rng(1))
    back = from_mujoco(robot, to_mujoco(robot, ours))
    assert back.names == ours.names
    for here, there in zip(back[:3], ours[:3], strict=True):
        np.testing.assert_allclose(here, there, atol=ROUNDING)


@pytest.mark.parametrize("name", ["talos_full", "romeo", "simple_humanoid_classical", "wheel"])
def test_mujoco_has_every_link_at_the_same_place_and_speed(name):
    """Two engines, one motion: each reads the URDF itself."""
    mujoco = pytest.importorskip("mujoco")
    robot = Wheel() if name == "wheel" else load_robot(name).robot
    theirs = mujoco_model(robot.urdf_text)
    moving = range(1, theirs.njnt)
    assert tuple(theirs.joint(i).name for i in moving) == mujoco_joint_names(robot.urdf_text)
    state = mujoco.MjData(theirs)
    pin.seed(2)
    ours = random_arrays(robot, np.random.default_rng(2), count=3)
    arrays = to_mujoco(robot, ours)
    model, data = robot.model, robot.model.createData()
    for k in range(len(ours.q)):
        state.qpos[:], state.qvel[:] = arrays.q[k], arrays.v[k]
        mujoco.mj_forward(theirs, state)
        pin.forwardKinematics(model, data, ours.q[k], ours.v[k])
        pin.updateFramePlacements(model, data)
        for body in range(1, theirs.nbody):
            frame = model.getBodyId(theirs.body(body).name)
            place = data.oMf[frame]
            np.testing.assert_allclose(state.xpos[body], place.translation, atol=ROUNDING)
            np.testing.assert_allclose(state.xmat[body].reshape(3, 3), place.rotation, atol=ROUNDING)
            velocity = np.zeros(6)
            mujoco.mj_objectVelocity(theirs, state, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
            expected = pin.getFrameVelocity(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
            np.testing.assert_allclose(velocity[:3], expected.angular, atol=ROUNDING)
            np.testing.assert_allclose(velocity[3:], expected.linear, atol=ROUNDING)
