"""The whole robot: what it takes from URDF and description, that its planar view is a view of it, and its pickles."""

import dataclasses
import pickle
import re
import xml.etree.ElementTree as ElementTree

import numpy as np
import pinocchio as pin
import pytest
from robot_laws import EXACT, close

from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model import FrontalBiped, Robot, Stance, load_robot, load_whole_robot, models_dir, robot_names
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.urdf.description import ROLL_JOINTS

FINGERPRINTS = {
    "alexander": "75daa70277f513fa",
    "frontal_biped": "e0725b2cc3a756e4",
    "frontal_biped_low_torso": "9ddb5d3a2bed2a27",
    "g1": "a4666c357f251e93",
    "human": "068e0dcaf50d6e0b",
    "icub": "c85fd2bcb9ed0bb6",
    "romeo": "602127c6a17349eb",
    "simple_humanoid_classical": "b6233b58d4950ac3",
    "talos_full": "3b1a71e85ad46487",
}
"""How those of version 0.1.0 begin: gait files of that version keep them."""

SOLE_ENDS = {
    "talos_full": (-0.110, 0.099),
    "g1": (-0.05, 0.12),
    "romeo": (-0.074, 0.121),
    "alexander": (-0.051, 0.149),
    "human": (-0.064, 0.207),
}
"""X of heel and toe from the ankle [m], measured once with other code on the lowest vertices of the feet."""

ICUB_FOOT = 0.156
"""Length of iCub's foot [m], measured likewise."""

ROUNDED_TO_MILLIMETRES = 1e-3
"""[m]; those numbers were noted in whole millimetres, and of vertices within 3 mm of the lowest."""


@pytest.fixture(scope="module", params=sorted(FINGERPRINTS))
def biped(request):
    return load_robot(request.param)


@pytest.fixture(scope="module")
def robot(biped):
    return biped.robot


def movable_joints(robot):
    """The <joint> elements that are not fixed, by name."""
    found = ElementTree.fromstring(robot.urdf_text).findall("joint")
    return {joint.get("name"): joint for joint in found if joint.get("type") != "fixed"}


def row_of(robot, joint):
    return robot.joint_names.index(joint)


class TestWhatTheFilesSay:
    def test_every_movable_joint_of_the_urdf(self, robot):
        assert sorted(robot.joint_names) == sorted(movable_joints(robot))
        names = list(robot.model.names)
        assert [names.index(name) for name in robot.joint_names] == list(range(2, robot.model.njoints))

    def test_limits_of_the_urdf_but_for_torques_that_the_description_gives(self, robot):
        torques = {"ankle": robot.description.ankle_torque, "hip": robot.description.hip_torque}
        given = {robot.description.joints[key]: torques[key.split("_")[1]] for key in ROLL_JOINTS}
        assert all(len(values) == len(robot.joint_names) for values in (*robot.limits, robot.armature))
        for name, element in movable_joints(robot).items():
            assert element.get("type") in ("revolute", "prismatic")  # of the packaged robots
            limit = {
                key: float(element.find("limit").get(key, "0")) for key in ("lower", "upper", "velocity", "effort")
            }
            if given.get(name) is not None:
                limit["effort"] = given[name]
            assert {key: getattr(robot.limits, key)[row_of(robot, name)] for key in limit} == limit, name

    def test_a_joint_without_end_has_no_limit(self, model_files):
        urdf, description = model_files
        link = '<link name="fan"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        joint = '<joint name="fan" type="continuous"><parent link="pelvis"/><child link="fan"/><axis xyz="0 0 1"/>'
        text = urdf.read_text(encoding="utf-8")
        urdf.write_text(text.replace("</robot>", f"{link}</inertial></link>{joint}</joint></robot>"), encoding="utf-8")
        robot = load_whole_robot(description)
        row = row_of(robot, "fan")
        assert (robot.limits.lower[row], robot.limits.upper[row]) == (-np.inf, np.inf)
        assert robot.limits.upper[row_of(robot, "left_hip")] == 1.0  # in whichever row it comes
        assert robot.mass == pytest.approx(load_whole_robot("frontal_biped").mass + 1.0, rel=1e-14)

    def test_torques_and_rotors_of_the_description(self, model_files):
        _, path = model_files
        text = path.read_text(encoding="utf-8")
        added = "[limits]\nankle_torque = 30\n[armature]\nankle = 0.25\nhip = 0.5\n[sole]"
        path.write_text(text.replace("[sole]", added), encoding="utf-8")
        robot = load_whole_robot(path)
        rows = [row_of(robot, robot.description.joints[key]) for key in ROLL_JOINTS]
        assert robot.limits.effort[rows].tolist() == [30.0, 150.0, 150.0, 30.0]
        assert robot.armature[rows].tolist() == [0.25, 0.5, 0.5, 0.25]
        # the model itself has them, both ways
        columns = [robot.model.joints[robot.model.getJointId(robot.joint_names[row])].idx_v for row in rows]
        assert robot.model.upperEffortLimit[columns].tolist() == (-robot.model.lowerEffortLimit[columns]).tolist()
        assert robot.model.upperEffortLimit[columns].tolist() == [30.0, 150.0, 150.0, 30.0]
        assert robot.model.armature[columns].tolist() == [0.25, 0.5, 0.5, 0.25]

    def test_it_stands_at_the_posture_of_the_description(self, robot):
        angles = dict.fromkeys(robot.joint_names, 0.0) | dict(robot.description.posture)
        columns = [robot.model.joints[robot.model.getJointId(name)].idx_q for name in angles]
        assert robot.posture[columns].tolist() == list(angles.values())
        assert robot.posture[:3].tolist() == [0.0, 0.0, 0.0]
        rotation = pin.Quaternion(robot.posture[3:7]).matrix()
        assert rotation == pytest.approx(pin.rpy.rpyToMatrix(*robot.description.base_rpy), abs=1e-12)

    def test_the_fingerprint_is_that_of_earlier_versions(self, robot):
        assert robot.fingerprint.startswith(FINGERPRINTS[robot.name])
        assert set(robot_names()) >= set(FINGERPRINTS)

    def test_what_the_frontal_plane_refuses_is_still_a_robot(self, model_files):
        """Only the view from the front asks for HR1 to HR5."""
        urdf, description = model_files
        text = urdf.read_text(encoding="utf-8")
        urdf.write_text(text.replace('<mass value="12.15"/>', '<mass value="9"/>', 1), encoding="utf-8")
        robot = load_whole_robot(description)
        with pytest.raises(HypothesisError, match="HR3"):
            FrontalBiped(robot)

    def test_it_cannot_be_changed_by_accident(self, robot):
        with pytest.raises(dataclasses.FrozenInstanceError):
            robot.posture = robot.posture.copy()
        for values in (robot.posture, robot.armature, *robot.limits):
            with pytest.raises(ValueError, match="read-only"):
                values[0] = 1.0


class TestThePlanarView:
    """What is seen from the front is the whole robot, before the legs are made equal."""

    def test_mass(self, biped):
        close(biped.mass, biped.robot.mass, EXACT, "mass")

    @pytest.mark.parametrize("stance", Stance)
    def test_centre_of_mass_at_the_posture(self, biped, stance):
        robot, chain = biped.robot, biped.measured.chain(biped.description.sole, stance)
        data = robot.model.createData()
        com = pin.centerOfMass(robot.model, data, robot.posture)
        ankle = data.oMi[robot.model.getJointId(biped.description.joints[f"{stance.value}_ankle"])].translation
        planar = sum(body.mass * body.com for body in chain.bodies) / chain.mass
        # h runs from the stance foot to the other one, v counts from the ground
        seen = [-stance.sign * (com[1] - ankle[1]), com[2] - ankle[2] + biped.ankle_height]
        close(planar, seen, EXACT, f"{robot.name}, {stance.value} stance")

    def test_limits_of_the_roll_joints(self, biped):
        chart, limits = biped.stance_map, biped.robot.limits
        for i, key in enumerate(ROLL_JOINTS):
            row, seen = row_of(biped.robot, chart.joint_names[i]), biped.measured.joint[key]
            turned = chart.axis_sign[i] * (np.array([limits.lower[row], limits.upper[row]]) - chart.reference[i])
            assert [seen.lower, seen.upper] == pytest.approx(sorted(turned), abs=1e-15)
            assert (seen.velocity, seen.effort) == (limits.velocity[row], limits.effort[row])
            assert seen.armature == biped.robot.armature[row]

    def test_locked_dynamics_are_rows_and_columns_of_the_whole_robots(self, biped):
        """Joints that do not move take no part, however the root moves in space."""
        robot, locked = biped.robot, biped.spatial_model
        rng = np.random.default_rng(5)
        q, q_locked = robot.posture.copy(), biped.spatial_reference.copy()
        columns = list(range(6))
        for name in locked.names[2:]:
            whole, part = (model.joints[model.getJointId(name)] for model in (robot.model, locked))
            q[whole.idx_q] = q_locked[part.idx_q] = q[whole.idx_q] + rng.uniform(-0.3, 0.3)
            columns.append(whole.idx_v)
        M = pin.crba(robot.model, robot.model.createData(), q)[np.ix_(columns, columns)]
        close(pin.crba(locked, locked.createData(), q_locked), M, EXACT, f"{robot.name}, mass matrix")
        v_locked = rng.uniform(-1.0, 1.0, locked.nv)
        v = np.zeros(robot.model.nv)
        v[columns] = v_locked
        bias = pin.nonLinearEffects(robot.model, robot.model.createData(), q, v)[columns]
        close(pin.nonLinearEffects(locked, locked.createData(), q_locked, v_locked), bias, EXACT, f"{robot.name}, bias")


class TestSoles:
    @pytest.mark.parametrize("name", SOLE_ENDS)
    def test_length_is_that_of_the_foots_shapes(self, name):
        for sole in load_whole_robot(name).soles:
            assert (-sole.back, sole.front) == pytest.approx(SOLE_ENDS[name], abs=ROUNDED_TO_MILLIMETRES)

    def test_meshes_that_lie_on_their_side_are_turned(self):
        """iCub's COLLADA files have Y up; read as they are, the foot would point to the side."""
        for sole in load_whole_robot("icub").soles:
            assert sole.length == pytest.approx(ICUB_FOOT, abs=ROUNDED_TO_MILLIMETRES)
            assert sole.front > sole.back

    def test_feet_without_shapes_are_described(self):
        """0.25 by 0.1 m in the SRDF, the ankle above the middle."""
        for sole in load_whole_robot("simple_humanoid_classical").soles:
            assert (sole.front, sole.back, sole.length, sole.width) == (0.125, 0.125, 0.25, 0.1)

    def test_width_and_height_are_those_of_the_plane(self, biped):
        for sole in biped.robot.soles:
            assert (-sole.outer, sole.inner) == biped.sole
            assert sole.ankle_height == pytest.approx(biped.ankle_height, abs=1e-15)

    def test_frames_and_edges_at_the_posture(self, biped):
        """Their frames look forward, left and up, below the ankles; the inner edges face each other."""
        robot = biped.robot
        data = robot.model.createData()
        pin.forwardKinematics(robot.model, data, robot.posture)
        corners = []
        for sole, side in zip(robot.soles, Stance, strict=True):
            assert (sole.side, sole.joint) == (side, robot.description.joints[f"{side.value}_ankle"])
            ankle = data.oMi[robot.model.getJointId(sole.joint)]
            frame = ankle * sole.placement
            assert frame.rotation == pytest.approx(np.eye(3), abs=1e-12)
            below = ankle.translation - [0.0, 0.0, sole.ankle_height]
            assert frame.translation == pytest.approx(below, abs=1e-12)
            corners.append(np.array([frame.act(corner) for corner in sole.corners]))
        left, right = corners
        assert left[:, 1].min() == pytest.approx(left[1, 1], abs=1e-12)
        assert right[:, 1].max() == pytest.approx(right[1, 1], abs=1e-12)
        assert left[:, 1].min() > right[:, 1].max()
        assert np.all(left[:2, 0] > left[2:, 0])

    def test_a_measured_foot_is_flat_and_its_sole_where_the_description_has_it(self, biped):
        """The lowest points of the feet lie in the sole's plane."""
        from frontal_biped.model.urdf.soles import measure_sole

        robot = biped.robot
        for sole in robot.soles:
            measured = measure_sole(robot.model, robot.posture, sole.joint, robot.description.urdf, robot.urdf_text)
            if measured is not None:
                assert measured.ankle_height == pytest.approx(sole.ankle_height, abs=ROUNDED_TO_MILLIMETRES)

    @pytest.mark.parametrize(("given", "ends"), [
        ("front = 0.2\nback = 0.05", (0.05, 0.2)),
        ("front = 0.2", (0.1, 0.2)),  # the box of the URDF reaches from -0.1 to 0.14 m
        ("back = 0.05", (0.05, 0.14)),
        ("", (0.1, 0.14)),
    ])  # fmt: skip
    def test_the_description_comes_first(self, model_files, given, ends):
        _, path = model_files
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("[sole]", f"[sole]\n{given}"), encoding="utf-8")
        robot = load_whole_robot(path)
        for sole in robot.soles:
            assert (sole.back, sole.front) == pytest.approx(ends, abs=1e-12)
        assert robot.fingerprint == load_whole_robot("frontal_biped").fingerprint  # the plane does not see it

    @pytest.mark.parametrize(("shapes", "words"), [
        ("", "neither collision nor visual shapes"),
        ('<collision><geometry><mesh filename="package://gone/foot.stl"/></geometry></collision>', "gone/foot.stl"),
        (
            '<collision><origin xyz="0.3 0 0"/><geometry><box size="0.2 0.1 0.02"/></geometry></collision>',
            "from +0.200 to +0.400 m, not to both sides of the ankle",
        ),
    ])  # fmt: skip
    def test_what_cannot_be_measured_is_asked_for(self, model_files, shapes, words):
        urdf, path = model_files
        text = urdf.read_text(encoding="utf-8")
        text = re.sub(r"<(visual|collision)[ >].*?</\1>", "", text, flags=re.DOTALL)
        urdf.write_text(text.replace('<link name="left_foot">', f'<link name="left_foot">{shapes}'), encoding="utf-8")
        robot = load_whole_robot(path)  # whoever does not ask for the length is not bothered
        FrontalBiped(robot)
        with pytest.raises(RobotError) as caught:
            robot.soles  # noqa: B018
        message = str(caught.value)
        assert "\n" not in message
        for word in ("frontal_biped.toml", "'left_ankle'", words, "give [sole] front, back"):
            assert word in message


class TestPickles:
    """By content: what became of the files does not matter."""

    def test_measured_soles_travel_along(self, monkeypatch):
        """The meshes they were measured on may not be there."""
        robot = load_whole_robot("talos_full")
        measured = robot.soles
        packed = pickle.dumps(robot)

        def gone(*_):
            raise AssertionError("measured again")

        monkeypatch.setattr("frontal_biped.model.robot.measure_sole", gone)
        twin = pickle.loads(packed)
        assert [(s.front, s.back, s.width) for s in twin.soles] == [(s.front, s.back, s.width) for s in measured]
        assert twin.soles.left.placement == measured.left.placement

    def test_a_changed_description_survives_a_change_of_its_files_and_their_loss(self, model_files):
        urdf, path = model_files
        loaded = load_whole_robot(path)
        sole = dataclasses.replace(loaded.description.sole, inner=0.03, front=0.2, back=0.1)
        robot = Robot(dataclasses.replace(loaded.description, sole=sole, hip_torque=77.0), loaded.urdf_text)
        biped = FrontalBiped(robot)
        assert robot.fingerprint != loaded.fingerprint
        packed = pickle.dumps((robot, biped))

        def same():
            twin, view = pickle.loads(packed)
            assert twin.description == view.description == robot.description
            assert twin.fingerprint == view.fingerprint == robot.fingerprint
            assert view.sole == (-0.05, 0.03)
            assert view.max_torque.tolist() == biped.max_torque.tolist() == [150.0, 77.0, 77.0, 150.0]
            assert view.robot is twin  # packed together, one robot
            assert twin.soles.left.front == 0.2
            assert twin.model == robot.model
            assert np.array_equal(twin.posture, robot.posture)
            q = UPRIGHT + np.array([0.1, -0.2, 0.3, 0.05])
            assert np.array_equal(view.D(q), biped.D(q))

        same()
        urdf.write_text(urdf.read_text(encoding="utf-8").replace('value="36.0"', 'value="35.0"'), encoding="utf-8")
        path.write_text(path.read_text(encoding="utf-8").replace("inner = 0.05", "inner = 0.02"), encoding="utf-8")
        same()
        urdf.unlink()
        path.unlink()
        same()

    def test_a_changed_reduction_survives(self):
        biped = load_robot("frontal_biped")
        chain = dataclasses.replace(biped.chain, max_velocity=np.full(4, 3.0))
        changed = FrontalBiped(biped.robot, biped.reduction._replace(chain=chain), fingerprint="changed")
        twin = pickle.loads(pickle.dumps(changed))
        assert twin.joint_max_velocity.tolist() == [3.0] * 4
        assert twin.fingerprint == "changed"
        assert twin.spatial_model == biped.spatial_model

    def test_every_packaged_robot(self, biped):
        twin = pickle.loads(pickle.dumps(biped))
        assert twin.fingerprint == biped.fingerprint
        assert twin.robot.joint_names == biped.robot.joint_names
        q = UPRIGHT + np.array([0.1, -0.2, 0.3, 0.05])
        assert np.array_equal(twin.D(q), biped.D(q))


def test_a_robot_of_a_description_is_that_of_its_name():
    robot = load_whole_robot("talos_full")
    assert robot.name == "talos_full"
    assert robot.description.path == models_dir() / "talos_full.toml"
    again = Robot.of(robot.description)
    assert again.fingerprint == robot.fingerprint
    assert again.model == robot.model
