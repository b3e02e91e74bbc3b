"""Postures with bent knees, against plane geometry done without Pinocchio's kinematics of the moved leg."""

import numpy as np
import pinocchio as pin
import pytest

from frontal_biped.cli import main
from frontal_biped.exceptions import RobotError
from frontal_biped.model import load_robot, load_whole_robot, models_dir
from frontal_biped.model.urdf.bent_posture import MARGINS, find_bent_posture
from frontal_biped.model.urdf.bent_proposal import ASSUMED_ARMATURE, STEP_SHARE, propose_bent_posture
from frontal_biped.model.urdf.description import read_description
from frontal_biped.model.urdf.legs import find_legs

BENT = {"romeo_bent": "romeo", "g1_bent": "g1", "icub_bent": "icub"}
"""Shipped robots with bent knees, and where the search began."""

SAME_ANGLE = 1e-6
"""[rad]; descriptions hold nine digits, and links of the URDFs are printed to five or six."""

SAME_LENGTH = 1e-6  # [m]


def found_for(name, step_length=None):
    """The posture found for a robot whose knees are straight."""
    robot = load_whole_robot(name)
    sole = robot.soles.left
    step = STEP_SHARE * load_robot(name).leg_length if step_length is None else step_length
    legs = find_legs(robot.model, name)
    start = robot.posture.copy()
    for names in (legs.left, legs.right):
        for i in legs.pitch:
            start[robot.model.joints[robot.model.getJointId(names[i])].idx_q] = 0.0
    return robot, find_bent_posture(robot.model, legs, robot.description.joints, start, step, (-sole.back, sole.front))


class SagittalLeg:
    """Left hip, knee and ankle pitch, and ankle roll joint of a robot at its posture: (x, z) of their origins."""

    def __init__(self, robot):
        model, data = robot.model, robot.model.createData()
        pin.computeJointJacobians(model, data, robot.posture)
        legs = find_legs(model, robot.name)
        last = legs.left.index(robot.description.joints["left_ankle"])
        names = [legs.left[i] for i in legs.pitch if i < last]
        self.hip, self.knee, self.ankle, self.foot = (
            data.oMi[model.getJointId(name)].translation[[0, 2]] for name in (*names, legs.left[last])
        )
        self.thigh = float(np.linalg.norm(self.knee - self.hip))
        self.shank = float(np.linalg.norm(self.ankle - self.knee))

    def flexion(self, ahead=0.0):
        """Angle between thigh and shank, the flat foot moved forwards, by the law of cosines."""
        reach = np.linalg.norm(self.ankle + np.array([ahead, 0.0]) - self.hip)
        cosine = (reach**2 - self.thigh**2 - self.shank**2) / (2.0 * self.thigh * self.shank)
        return float(np.arccos(min(cosine, 1.0)))  # straight, where the place is out of reach


@pytest.fixture(params=BENT)
def bent(request):
    return load_whole_robot(request.param)


def test_feet_are_flat_and_the_pelvis_is_upright(bent):
    """All of each sole touches the ground at once: its lowest points lie within the rounding of the meshes."""
    assert np.all(np.abs(np.array(bent.description.base_rpy)[:2]) == 0.0)
    from frontal_biped.model.urdf.soles import measure_sole

    for sole in bent.soles:
        measured = measure_sole(bent.model, bent.posture, sole.joint, bent.description.urdf, bent.urdf_text)
        assert measured.toe - measured.heel > 0.14


def test_there_is_room_for_the_step(bent):
    leg = SagittalLeg(bent)
    half = 0.5 * STEP_SHARE * float(np.linalg.norm(leg.hip - leg.foot))
    assert min(leg.flexion(half), leg.flexion(-half)) > MARGINS[0].straight - SAME_ANGLE
    # and hardly more than that: knees cost torque
    assert min(leg.flexion(1.4 * half), leg.flexion(-1.4 * half)) < MARGINS[0].straight


def test_the_centre_of_mass_is_well_inside_the_soles(bent):
    data = bent.model.createData()
    com = pin.centerOfMass(bent.model, data, bent.posture)[0]
    for sole in bent.soles:
        ahead = com - data.oMi[bent.model.getJointId(sole.joint)].translation[0]
        assert -0.75 * sole.back < ahead < 0.75 * sole.front


def test_joints_keep_away_from_their_limits(bent):
    legs = find_legs(bent.model, bent.name)
    for name in (*legs.left, *legs.right):
        row, joint = bent.joint_names.index(name), bent.model.joints[bent.model.getJointId(name)]
        angle = bent.posture[joint.idx_q]
        assert bent.limits.lower[row] + 0.04 <= angle <= bent.limits.upper[row] - 0.04


def test_it_is_what_the_search_finds(bent, tmp_path):
    path = tmp_path / "again.toml"
    path.write_text(propose_bent_posture(models_dir() / f"{BENT[bent.name]}.toml", name=bent.name).text)
    again = read_description(path)
    assert dict(again.posture) == pytest.approx(dict(bent.description.posture), abs=SAME_ANGLE)
    assert (again.name, again.virtual_legs) == (bent.name, bent.description.virtual_legs)
    assert again.sole == bent.description.sole


def test_leg_length_and_static_torque():
    """Romeo by hand: the length in the plane, and the knee's torque from weight and lever."""
    robot, found = found_for("romeo")
    q, model = robot.posture.copy(), robot.model
    for name, angle in found.angles.items():
        q[model.joints[model.getJointId(name)].idx_q] = angle
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    hip, knee, ankle = (
        data.oMi[model.getJointId(f"L{part}")].translation for part in ("HipRoll", "KneePitch", "AnkleRoll")
    )
    assert found.leg_length == pytest.approx(np.linalg.norm((hip - ankle)[1:]), abs=SAME_LENGTH)
    # what is below the knee stands on the ground: the weight of the rest passes the knee at a distance
    com = pin.centerOfMass(model, data, q)
    pin.computeSubtreeMasses(model, data)
    shank = model.getJointId("LKneePitch")
    below = data.mass[shank]
    below_x = data.oMi[shank].act(data.com[shank])[0]
    moment = 9.81 * (robot.mass * (com[0] - knee[0]) - below * (below_x - knee[0]))
    limit = robot.limits.effort[robot.joint_names.index("LKneePitch")]
    assert abs(found.torques["LKneePitch"]) == pytest.approx(abs(moment) / limit, rel=1e-3)


def test_more_room_takes_more_bend():
    flexions = [found_for("romeo", step)[1].flexion for step in (0.1, 0.2, 0.3)]
    assert flexions[0] < flexions[1] < flexions[2]


def test_virtual_legs_are_asked_for_where_the_roll_axes_leave_x():
    for name, tilted in (("romeo", False), ("g1", True)):
        proposal = propose_bent_posture(models_dir() / f"{name}.toml", 0.1)
        assert ("virtual_legs = true" in proposal.text) is tilted
        assert proposal.undecided == ()


def test_limits_that_do_not_allow_the_step_are_named():
    """The toy humanoid's ankles cannot bend back: it may stand a little bent, and no more."""
    proposal = propose_bent_posture(models_dir() / "simple_humanoid_classical.toml", 0.1)
    assert any("room for steps of 0.000 m, not of 0.100 m" in line for line in proposal.undecided)


def test_a_leg_without_a_knee_is_refused():
    robot = load_whole_robot("frontal_biped")
    legs = find_legs(robot.model, "frontal_biped")
    with pytest.raises(
        RobotError, match="2 joints down to the ankle roll joint, left_hip, left_ankle; a leg that bends"
    ):
        find_bent_posture(robot.model, legs, robot.description.joints, robot.posture, 0.1)


def test_the_command(tmp_path, capsys):
    out = tmp_path / "romeo_bent.toml"
    assert main(["robots", "--bend", "romeo", "--step-length", "0.12", "-o", str(out)]) == 0
    robot = load_robot(out)
    assert robot.robot.armature == pytest.approx(ASSUMED_ARMATURE)
    assert robot.leg_length < load_robot("romeo").leg_length - 0.005
    assert main(["robots", "--bend", "romeo", "--step-length", "0"]) == 2
    assert "--step-length" in capsys.readouterr().err
