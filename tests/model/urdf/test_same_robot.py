"""One small humanoid in all the ways that URDFs are written: it stays the same robot, or the difference is said."""

import re
from pathlib import Path

import numpy as np
import pytest

from frontal_biped.cli import main
from frontal_biped.exceptions import HypothesisError, RobotError
from frontal_biped.model import load_robot, load_whole_robot
from frontal_biped.model.urdf.bent_proposal import propose_walking_description
from frontal_biped.model.urdf.description import read_description
from frontal_biped.model.urdf.inertia_check import check_inertias
from frontal_biped.model.urdf.proposal import propose_description, propose_posture
from frontal_biped.model.urdf.read import read_urdf
from frontal_biped.model.urdf.soles import SOLE_THICKNESS

MINI = (Path(__file__).parents[2] / "data" / "mini.urdf").read_text(encoding="utf-8")
MASS = 44.6  # [kg]; the sum of its file's masses

DESCRIPTION = """name = "mini"
urdf = "mini.urdf"
[joints]
left_ankle = "left_ankle_roll_j"
left_hip = "left_hip_roll_j"
right_hip = "right_hip_roll_j"
right_ankle = "right_ankle_roll_j"
[sole]
inner = 0.05
outer = 0.05
ankle_height = 0.06
"""

RED_BOX = (
    '<visual><geometry><box size="0.1 0.1 0.1"/></geometry><material{}><color rgba="1 0 0 1"/></material></visual>'
)


def edited(pattern, replacement, text=MINI):
    found, count = re.subn(pattern, replacement, text)
    assert count
    return found


def below(root):
    """The robot, hung from what is given."""
    return edited('<robot name="mini">', f'<robot name="mini">{root}')


def shared_names():
    """Every link has the name of the joint above it, as NAO's and many others' have."""
    text = MINI
    for joint, child in re.findall(r'<joint name="(\w+)".*?<child link="(\w+)"', MINI):
        text = text.replace(f'"{joint}"', f'"{child}"')
    return text


def rods():
    """With rods beside the legs, in front of the thighs, that end at the height of the ankles."""
    text = ""
    for side in ("left", "right"):
        parent = f"{side}_yoke"
        for rod, x, z in (("rod", 0.04, 0.0), ("rod2", 0.0, -0.66)):
            text += (
                f'<link name="{side}_{rod}"><inertial><origin xyz="0 0 -0.3"/><mass value="1e-6"/>'
                '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{side}_{rod}_pitch" type="revolute">'
                f'<parent link="{parent}"/><child link="{side}_{rod}"/>'
                f'<origin xyz="{x} 0 {z}"/><axis xyz="0 1 0"/>'
                '<limit lower="-1.5" upper="1.5" effort="90" velocity="9"/></joint>'
            )
            parent = f"{side}_{rod}"
    return edited("</robot>", text + "</robot>")


PITCH_SLIDES = (("right_hip_pitch_j", (0.0, 0.03, 0.0)), ("right_knee_j", (0.0, -0.05, 0.0)))
HIP_ROLL_SLIDES = (("right_hip_roll_j", (0.06, 0.0, 0.0)),)


def slid_along_axes(slides):
    """Joints have their origins elsewhere on their axes; links and shapes stay where they were."""
    text = MINI
    for joint, slide in slides:
        child, x, y, z = re.search(rf'name="{joint}".*?child link="(\w+)".*?xyz="(\S+) (\S+) (\S+)"', text).groups()
        moved = " ".join(str(float(a) + b) for a, b in zip((x, y, z), slide, strict=True))
        text = edited(rf'(name="{joint}".*?child link="\w+)(".*?xyz=)"[^"]*"', rf'\1_slid\2"{moved}"', text)
        # what hangs below is moved back by a fixed joint
        back = " ".join(str(-part) for part in slide)
        text = edited(
            "</robot>",
            f'<link name="{child}_slid"/><joint name="{child}_back" type="fixed"><parent link="{child}_slid"/>'
            f'<child link="{child}"/><origin xyz="{back}"/></joint></robot>',
            text,
        )
    return text


WAYS = {
    "a blank behind a mass": edited('<mass value="5.0"/>', '<mass value="5.0 "/>'),
    "a line break in a mass": edited('<mass value="5.0"/>', '<mass value="5.0\n"/>'),
    "a blank behind an inertia": edited('ixx="0.06"', 'ixx="0.06 "'),
    "a tab in a vector": edited('xyz="0 0 -0.35"', 'xyz="0\t0\t-0.35"'),
    "a written tab in a vector": edited('xyz="0 0 -0.35"', 'xyz="0&#9;0 -0.35"'),
    "a blank behind a limit": edited('effort="90"', 'effort="90 "'),
    "blanks in damping": edited('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/><dynamics damping=" 0 "/>'),
    "a moment below all numbers": edited('ixy="0"', 'ixy="1e-400"'),
    "names that links and joints share": shared_names(),
    "a material without a name": edited("<collision>", RED_BOX.format("") + "<collision>"),
    "a material of all without a name": below('<material><color rgba="1 0 0 1"/></material>'),
    "a material twice": below(2 * '<material name="a"><color rgba="1 0 0 1"/></material>'),
    "a visual without a geometry": edited("<collision>", "<visual/><collision>"),
    "a collision without a shape": edited("<collision>", "<collision><geometry/></collision><collision>"),
    "a root on the floor": below(
        '<link name="base_footprint"/><joint name="s" type="fixed"><parent link="base_footprint"/>'
        '<child link="body"/><origin xyz="0 0 0.74"/></joint>'
    ),
    "a root far beside": below(
        '<link name="odom"/><joint name="s" type="fixed"><parent link="odom"/><child link="body"/>'
        '<origin xyz="0.3 1.2 0.1"/></joint>'
    ),
    "a floating joint": below(
        '<link name="world"/><joint name="s" type="floating"><parent link="world"/><child link="body"/>'
        '<origin xyz="0 0 0.74"/></joint>'
    ),
    "a fixed world": below(
        '<link name="world"/><joint name="s" type="fixed"><parent link="world"/><child link="body"/></joint>'
    ),
    "joints without ends": edited(r'type="revolute"(.*?) lower="\S+" upper="\S+"', r'type="continuous"\1'),
    "rods beside the legs": rods(),
    "origins of pitch joints elsewhere on their axes": slid_along_axes(PITCH_SLIDES),
    "the origin of a hip roll joint elsewhere on its axis": slid_along_axes(HIP_ROLL_SLIDES),
}


def written(folder, text, description=None):
    (folder / "mini.urdf").write_text(text, encoding="utf-8")
    if description is not None:
        (folder / "mini.toml").write_text(description, encoding="utf-8")
    return folder / ("mini.urdf" if description is None else "mini.toml")


@pytest.fixture(scope="module")
def mini(tmp_path_factory):
    """The robot as it was proposed for the plain file."""
    folder = tmp_path_factory.mktemp("mini")
    proposal = propose_description(written(folder, MINI))
    assert proposal.undecided == ()
    (folder / "mini.toml").write_text(proposal.text, encoding="utf-8")
    return load_robot(folder / "mini.toml")


@pytest.mark.parametrize("way", WAYS)
def test_it_stays_the_same_robot(way, mini, tmp_path, capfd):
    urdf = written(tmp_path, WAYS[way])
    proposal = propose_description(urdf)
    assert proposal.undecided == ()
    robot = load_robot(written(tmp_path, WAYS[way], proposal.text))
    assert robot.mass == pytest.approx(MASS, rel=1e-6)
    for q in (np.full(4, -1.5), np.array([-1.4, -1.7, -1.6, -1.3])):
        assert robot.D(q) == pytest.approx(mini.D(q), rel=1e-5, abs=1e-9)
    assert robot.sole == mini.sole
    assert robot.robot.soles.left.length == mini.robot.soles.left.length
    if way != "names that links and joints share":
        assert dict(robot.description.joints) == dict(mini.description.joints)
    assert capfd.readouterr().err == ""  # nor does any reader complain


@pytest.mark.parametrize("way", ["names that links and joints share", "a floating joint", "a root on the floor"])
def test_mujoco_reads_the_same_robot(way, mini, tmp_path):
    pytest.importorskip("mujoco")
    from frontal_biped.model.space.free_robot import FreeRobot
    from frontal_biped.simulation.mujoco.space_model import mujoco_space_model

    robot = load_whole_robot(written(tmp_path, WAYS[way], propose_description(written(tmp_path, WAYS[way])).text))
    model = mujoco_space_model(FreeRobot(robot))
    assert sum(model.body_mass) == pytest.approx(MASS, rel=1e-9)
    assert model.nv == 6 + len(mini.robot.joint_names)


@pytest.mark.parametrize("way", WAYS)
def test_a_text_in_normal_form_stays_as_it_is(way, tmp_path):
    """Fingerprints are made of it: what was put right needs nothing more."""
    urdf = written(tmp_path, WAYS[way])
    once = read_urdf(urdf)
    urdf.write_text(once, encoding="utf-8")
    assert read_urdf(urdf) == once
    assert read_urdf(written(tmp_path, MINI)) == MINI


@pytest.mark.parametrize("spelling", ["5_0", "٥", "0x5", "5,0", "5 0", "1d1", "infinity", "1e999"])
@pytest.mark.parametrize(
    ("pattern", "where"),
    [
        ('<mass value="5.0"/>', "link 'left_thigh'"),
        ('ixx="0.06"', "link 'left_thigh'"),
        ('upper="2.2"', "joint 'left_knee_j'"),
    ],
)
def test_what_only_some_readers_call_a_number_is_refused(spelling, pattern, where, tmp_path):
    key = pattern.split('"')[0].split()[-1]
    urdf = written(tmp_path, edited(pattern, re.sub('"[^"]*"', f'"{spelling}"', pattern)))
    with pytest.raises(RobotError, match=f"{where}: {key}'{spelling}' is not a finite number; write"):
        read_urdf(urdf)


def test_what_pinocchio_drops_is_found_out(mini):
    """Masses and moments of the text are summed for every body, independently."""
    text, full = mini.robot.urdf_text, mini.robot.model
    check_inertias("mini.urdf", full, text)
    with pytest.raises(RobotError, match=r"44\.6 kg of 45\.6 kg; look at the <inertial> of 'left_thigh'"):
        check_inertias("mini.urdf", full, text.replace('<mass value="5.0"/>', '<mass value="6.0"/>', 1))
    for old, new in (('ixx="0.06"', 'ixx="0.061"'), ('xyz="0 0.01 -0.15"', 'xyz="0 0.011 -0.15"')):
        with pytest.raises(RobotError, match=r"reads other inertias than the file gives; .* 'left_thigh'"):
            check_inertias("mini.urdf", full, text.replace(old, new, 1))


@pytest.mark.parametrize(
    "text",
    [
        edited('<mass value="5.0"/>', '<mass value="${m}"/>'),
        edited("</robot>", '<xacro:leg side="left"/></robot>'),
        edited("</robot>", '<xacro:leg xmlns:xacro="http://ros.org/wiki/xacro" side="left"/></robot>'),
        '<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include filename="a"/></robot>',
    ],
)
def test_a_xacro_file_is_called_so(text, tmp_path, capsys):
    assert main(["robots", "--describe", str(written(tmp_path, text))]) == 2
    message = capsys.readouterr().err
    assert "this is a xacro file; run `xacro mini.urdf > robot.urdf` first" in message
    assert message.count("\n") == 1


def test_an_expanded_xacro_file_is_a_urdf(tmp_path):
    text = MINI.replace('<robot name="mini">', '<robot name="mini" xmlns:xacro="http://ros.org/wiki/xacro">')
    assert read_urdf(written(tmp_path, text)) == text


@pytest.mark.parametrize(("scale", "unit"), [(1e3, "millimetres"), (1e2, "centimetres"), (1e-3, "kilometres")])
def test_lengths_that_are_no_metres_are_asked_about(scale, unit, tmp_path):
    def scaled(match):
        return f'{match[1]}="{" ".join(repr(scale * float(word)) for word in match[2].split())}"'

    text = re.sub(r'(origin xyz|size)="([^"]*)"', scaled, MINI)
    undecided = propose_description(written(tmp_path, text)).undecided
    assert any(f"is the file in {unit}?" in line and f"hips {0.18 * scale:.3g} m apart" in line for line in undecided)


def test_a_foot_of_capsules_is_measured(tmp_path):
    """Two capsules along X, 0.08 m apart: radius 0.01 m, 0.2 m from end to end."""
    capsules = "".join(
        f'<collision><origin xyz="0.03 {y} -0.05" rpy="0 1.5707963267948966 0"/>'
        '<geometry><capsule radius="0.01" length="0.18"/></geometry></collision>'
        for y in (0.04, -0.04)
    )
    text = edited(r'<collision>(?:(?!</collision>).)*size="0.2 0.1 0.02".*?</collision>', capsules)
    proposal = propose_description(written(tmp_path, text))
    assert proposal.undecided == ()
    sole = read_description(written(tmp_path, text, proposal.text)).sole
    assert sole.ankle_height == pytest.approx(0.06, abs=1e-4)
    # what is less than SOLE_THICKNESS above the ground belongs to the sole
    beside = (0.01**2 - (0.01 - SOLE_THICKNESS) ** 2) ** 0.5
    assert 0.04 <= sole.inner == sole.outer <= 0.04 + beside
    # of a round end its lowest point counts
    assert (sole.front, sole.back) == pytest.approx((0.12, 0.06), abs=1e-3)


# ------------------------------------------------------------------ legs, arms, and what the user says
def bust():
    """The upper half of a robot: what hangs from it are arms."""
    text = edited('<origin xyz="0 0.09 0"/>', '<origin xyz="0 0.2 0.25"/>')
    text = edited('<origin xyz="0 -0.09 0"/>', '<origin xyz="0 -0.2 0.25"/>', text)
    return edited('<origin xyz="0 0 0.2"/><mass value="24.0"/>', '<origin xyz="0 0 0.1"/><mass value="24.0"/>', text)


def test_arms_are_not_silently_legs(tmp_path):
    undecided = propose_description(written(tmp_path, bust())).undecided
    assert any("hangs above the centre of mass of the rest, as an arm does" in line for line in undecided)


def test_arms_that_reach_as_low_as_legs_are_passed_over(mini, tmp_path):
    """Mini with arms that reach to its ankles."""
    text = MINI
    for side, y in (("left", 0.3), ("right", -0.3)):
        parent = "body"
        for i, (axis, height) in enumerate((("1 0 0", 0.3), ("0 1 0", -0.5), ("1 0 0", -0.48))):
            link = f"{side}_arm{i}"
            text = edited(
                "</robot>",
                f'<link name="{link}"><inertial><mass value="0.2"/>'
                '<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>'
                f'<joint name="{link}_j" type="revolute"><parent link="{parent}"/><child link="{link}"/>'
                f'<origin xyz="0 {y if i == 0 else 0} {height}"/><axis xyz="{axis}"/>'
                '<limit lower="-1" upper="1" effort="9" velocity="9"/></joint></robot>',
                text,
            )
            parent = link
    found = propose_description(written(tmp_path, text))
    assert found.undecided == ()
    assert dict(read_description(written(tmp_path, text, found.text)).joints) == dict(mini.description.joints)


def test_two_pairs_that_could_both_be_legs_are_named_and_a_description_decides(tmp_path):
    """The rods roll too now; only somebody can know which are the legs."""
    text = edited(r'(_rod2?_pitch".*?)<axis xyz="0 1 0"/>', r'\1<axis xyz="1 0 0"/>', rods())
    with pytest.raises(HypothesisError, match=r"left_hip_roll_j to left_ankle_roll_j.*left_rod2_pitch.*--posture"):
        propose_description(written(tmp_path, text))
    mimicking = edited(r'(_rod2?_pitch".*?)</joint>', r'\1<mimic joint="left_knee_j"/></joint>', text)
    assert propose_description(written(tmp_path, mimicking)).undecided == ()
    path = written(tmp_path, text, DESCRIPTION)
    assert propose_posture(path).undecided == ()


def test_an_ankle_of_another_leg_is_refused(tmp_path):
    path = written(tmp_path, MINI, DESCRIPTION.replace('"left_ankle_roll_j"', '"right_knee_j"'))
    with pytest.raises(HypothesisError, match="left_ankle = 'right_knee_j' is not of the left leg"):
        propose_posture(path)


def test_sides_follow_the_description(tmp_path):
    """What somebody calls left is left: named the other way round, the robot looks backwards."""
    keys, joints = DESCRIPTION.split("[sole]")[0].split("[joints]\n")
    swapped = "".join(
        f"{left} = {right}\n"
        for left, right in zip(
            [line.split(" = ")[0] for line in joints.splitlines()],
            [line.split(" = ")[1] for line in reversed(joints.splitlines())],
            strict=True,
        )
    )
    text = f"{keys}[joints]\n{swapped}[sole]{DESCRIPTION.split('[sole]')[1]}"
    assert 'left_hip = "right_hip_roll_j"' in text
    proposal = propose_posture(written(tmp_path, MINI, text))
    assert "rpy = [0.0, 0.0, 3.14" in proposal.text


def test_ankles_with_origins_apart_are_said(tmp_path):
    """Nothing in the plane depends on it, but soles are measured from there."""
    text = slid_along_axes((("right_ankle_roll_j", (0.04, 0.0, 0.0)),))
    (line,) = propose_description(written(tmp_path, text)).undecided
    assert "right_ankle_roll_j is +0.040 m ahead of that of left_ankle_roll_j" in line


def test_an_ankle_that_rolls_above_its_pitch_joint_walks_in_the_plane_only(tmp_path):
    """The refusal in space names the joint that is in the way."""
    text = MINI
    for side in ("left", "right"):
        roll, pitch = f'"{side}_ankle_roll_j"', f'"{side}_ankle_pitch_j"'
        text = text.replace(roll, "@").replace(pitch, roll).replace("@", pitch)
        text = edited(rf'(name={roll}.*?axis xyz=)"0 1 0"', r'\1"1 0 0"', text)
        text = edited(rf'(name={pitch}.*?axis xyz=)"1 0 0"', r'\1"0 1 0"', text)
    urdf = written(tmp_path, text)
    assert propose_description(urdf).undecided == ()
    with pytest.raises(RobotError, match="here left_ankle_pitch_j moves below the ankle roll joint"):
        propose_walking_description(urdf, tmp_path)


# ------------------------------------------------------------------ a posture that was given
KNEES = "[posture]\nleft_knee_j = 0.4\nright_knee_j = 0.4\n"


@pytest.mark.parametrize("given", [KNEES, "[posture]\nleft_knee_j = 0.4\n", "[posture]\nright_knee_j = 0.4\n"])
def test_a_bent_knee_stays_bent(given, tmp_path, capsys):
    path = written(tmp_path, MINI, DESCRIPTION + given)
    out = tmp_path / "found.toml"
    assert main(["robots", "--posture", str(path), "-o", str(out)]) == 0
    assert "changed" not in capsys.readouterr().err
    posture = read_description(out).posture
    assert posture["left_knee_j"] == posture["right_knee_j"] == pytest.approx(0.4, abs=1e-9)
    # hip and ankle turn back what the knee turns: the feet are flat
    for side in ("left", "right"):
        assert sum(posture[f"{side}_{joint}_j"] for joint in ("hip_pitch", "knee", "ankle_pitch")) == pytest.approx(
            0.0, abs=1e-7
        )
    load_robot(out)


def test_angles_that_cannot_stay_are_said(tmp_path, capsys):
    """Hip and knee lean the robot over its toes; no ankle brings it back."""
    given = "[posture]\nleft_knee_j = 0.4\nright_knee_j = 0.5\nleft_hip_pitch_j = 0.6\n"
    path = written(tmp_path, MINI, DESCRIPTION + given)
    out = tmp_path / "found.toml"
    assert main(["robots", "--posture", str(path), "-o", str(out)]) == 0
    posture = read_description(out).posture
    (line,) = (line for line in capsys.readouterr().out.splitlines() if "changed" in line)
    for name, old in (("left_knee_j", "0.4"), ("right_knee_j", "0.5"), ("left_hip_pitch_j", "0.6")):
        assert f"{name} from {old} to {posture[name]:g}" in line
    assert line.split("changed: ")[1].strip() in out.read_text(encoding="utf-8")


# ------------------------------------------------------------------ files
def meshed(folder):
    """Mini whose soles are boxes of a file, in a package whose name is not that of its folder."""
    box = '<box size="0.2 0.1 0.02"/>'
    corners = np.array([[i, j, k] for i in (-0.1, 0.1) for j in (-0.05, 0.05) for k in (-0.01, 0.01)])
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "sole.obj").write_text(
        vertices + "".join(f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in quads), encoding="utf-8"
    )
    return edited(box, '<mesh filename="package://mini_description/meshes/sole.obj"/>')


@pytest.mark.parametrize("below_package", ["", "urdf"])
def test_meshes_are_found_where_the_package_is_called_otherwise(below_package, mini, tmp_path):
    text = meshed(tmp_path)
    (tmp_path / below_package).mkdir(exist_ok=True)
    proposal = propose_description(written(tmp_path / below_package, text))
    assert proposal.undecided == ()
    robot = load_robot(written(tmp_path / below_package, text, proposal.text))
    assert robot.sole == pytest.approx(mini.sole, abs=1e-4)


def test_the_page_has_these_meshes_too(tmp_path, caplog):
    meshcat = pytest.importorskip("meshcat")
    from frontal_biped.viewer.page import SceneRecorder
    from frontal_biped.viewer.robot_shapes import draw_robot

    robot = load_robot(written(tmp_path, meshed(tmp_path), DESCRIPTION))
    recorder = SceneRecorder()
    draw_robot(meshcat.Visualizer(window=recorder)["robot"], robot)
    assert caplog.records == []
    drawn = {command["path"] for command in recorder.commands if command["type"] == "set_object"}
    assert any("left_ankle_roll_j/left_foot" in path for path in drawn)


def test_a_missing_mesh_has_a_remedy(tmp_path):
    undecided = propose_description(written(tmp_path, meshed(tmp_path / "elsewhere"))).undecided
    assert any("ROS_PACKAGE_PATH" in line and "AMENT_PREFIX_PATH" in line for line in undecided)


def test_a_package_on_the_ros_path_comes_first(tmp_path, monkeypatch, mini):
    """Where the name is right somewhere, the file of that package is taken."""
    text = meshed(tmp_path / "ros" / "mini_description")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "sole.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    proposal = propose_description(written(tmp_path, text))
    assert load_robot(written(tmp_path, text, proposal.text)).sole == pytest.approx(mini.sole, abs=1e-4)


@pytest.mark.parametrize("where", ["file", "folder"])
def test_a_name_that_is_not_utf8_is_told_in_one_line(where, tmp_path, capsys):
    odd = "r\udce9"  # Latin-1's e acute, as Python hands on bytes that are no UTF-8
    folder = tmp_path / odd if where == "folder" else tmp_path
    try:
        folder.mkdir(exist_ok=True)
    except (OSError, UnicodeEncodeError):
        pytest.skip("this file system takes UTF-8 names only")
    urdf = folder / ("mini.urdf" if where == "folder" else f"{odd}.urdf")
    urdf.write_text(MINI, encoding="utf-8")
    assert main(["robots", "--describe", str(urdf)]) == 2
    message = capsys.readouterr().err
    assert "is not UTF-8; rename it" in message
    assert message.count("\n") == 1
    with pytest.raises(RobotError, match="not UTF-8"):
        propose_description(urdf)
