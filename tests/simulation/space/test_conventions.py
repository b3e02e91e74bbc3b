"""Arrays for Pinocchio and MuJoCo: there and back, and MuJoCo itself agrees where every link is and how it moves."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.model import load_robot
from frontal_biped.simulation.space.conventions import (
    JointArrays,
    convention_arrays,
    from_mujoco,
    mujoco_arrays,
    mujoco_joint_names,
    pinocchio_arrays,
    to_mujoco,
)

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


def mujoco_model(urdf_text):
    """MuJoCo's own reading of a URDF without its shapes, the root link free."""
    mujoco = pytest.importorskip("mujoco")
    root = ElementTree.fromstring(urdf_text)
    for link in root.findall("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    options = {"fusestatic": "false", "balanceinertia": "true", "boundmass": "1e-6", "boundinertia": "1e-9"}
    ElementTree.SubElement(ElementTree.SubElement(root, "mujoco"), "compiler", options)
    spec = mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode"))
    spec.worldbody.first_body().add_freejoint()
    return spec.compile()


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


def test_the_power_of_the_joints_is_the_same_in_both(talos, bend):
    ours, theirs = pinocchio_arrays(talos, bend), mujoco_arrays(talos, bend)
    power = np.einsum("ti,ti->t", bend.tau, bend.v[:, 6:])
    for arrays in (ours, theirs):
        np.testing.assert_allclose(np.einsum("ti,ti->t", arrays.tau, arrays.v[:, 6:]), power, rtol=ROUNDING, atol=1e-9)


def test_every_joint_of_the_urdf_is_there_and_those_held_stay_at_the_posture(talos, bend):
    arrays = convention_arrays(talos, bend)
    assert len(arrays["pinocchio_joints"]) == len(talos.joint_names) + len(talos.locked) == 44
    assert set(arrays["mujoco_joints"]) == set(arrays["pinocchio_joints"])
    held = [list(arrays["mujoco_joints"]).index(name) for name in talos.locked]
    assert np.ptp(arrays["mujoco_qpos"][:, [7 + i for i in held]], axis=0).max() == 0.0
    assert not arrays["mujoco_qvel"][:, [6 + i for i in held]].any()
    # the whole model and the one without fingers have their mass at the same place
    full, data = talos.robot.model, talos.robot.model.createData()
    com = [pin.centerOfMass(full, data, q).copy() for q in arrays["pinocchio_q"][::50]]
    np.testing.assert_allclose(com, bend.com[::50], atol=ROUNDING)
