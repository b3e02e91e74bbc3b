"""Malformed and unsuitable robots on the command line: one line with cause and remedy, nothing written, no hang."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from frontal_biped.cli import main
from frontal_biped.model import models_dir
from frontal_biped.model.urdf.packages import example_robot_data_dir

PATIENCE = 10.0  # [s]; every refusal takes well below one

URDF = (models_dir() / "frontal_biped.urdf").read_text(encoding="utf-8")
DESCRIPTION = (models_dir() / "frontal_biped.toml").read_text(encoding="utf-8")

LEFT_HIP = '<joint name="left_hip" type="revolute"'
MASS = '<mass value="36.0"/>'
MESH = '<mesh filename="{}"/>'
SPHERE = '<sphere radius="0.10"/>'

ENTITY_BOMB = (
    '<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">'
    '<!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">]>'
)
EXTERNAL_ENTITY = '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]>'


def edited(original: str, replacement: str, count: int = 1) -> str:
    assert original in URDF
    return URDF.replace(original, replacement, count)


def many_links(count: int) -> str:
    return '<robot name="x">' + "".join(f'<link name="l{i}"/>' for i in range(count)) + "</robot>"


def cycle() -> str:
    loop = '<joint name="loop" type="fixed"><parent link="left_foot"/><child link="pelvis"/></joint>'
    return edited("</robot>", loop + "</robot>")


HIP_LIMIT = '<limit lower="-1.0" upper="1.0" effort="150" velocity="10"/>'

# what is wrong: (text of the URDF, what the message says, its remedy)
BAD_URDF = {
    "fixed joint": (edited(LEFT_HIP, '<joint name="left_hip" type="fixed"'), "'left_hip' is fixed", "revolute"),
    "continuous joint without limits": (
        edited(LEFT_HIP, '<joint name="left_hip" type="continuous"').replace(HIP_LIMIT, "", 1),
        "left_hip",
        "revolute",
    ),
    "planar joint": (edited(LEFT_HIP, '<joint name="left_hip" type="planar"'), "left_hip", "revolute"),
    "floating joint": (edited(LEFT_HIP, '<joint name="left_hip" type="floating"'), "left_hip", "revolute"),
    "prismatic joint": (edited(LEFT_HIP, '<joint name="left_hip" type="prismatic"'), "left_hip", "revolute"),
    "negative mass": (edited(MASS, '<mass value="-36.0"/>'), "-36 kg is negative", "positive mass"),
    "zero inertia": (edited('ixx="5.53"', 'ixx="0"'), "moment of inertia of 0", "positive ixx"),
    "infinite mass": (edited(MASS, '<mass value="inf"/>'), "finite number", "pelvis"),
    "cyclic links": (cycle(), "its own ancestor", "break the loop"),
    "entity bomb": (edited('<?xml version="1.0"?>', ENTITY_BOMB), "DOCTYPE or entity", "remove"),
    "external entity": (edited('<?xml version="1.0"?>', EXTERNAL_ENTITY), "DOCTYPE or entity", "remove"),
    "nested deep": ("<robot name='x'>" + "<a>" * 100_000, "nested more than", "is this a URDF"),
    "too many links": (many_links(1001), "1001 links", "remove"),
    "mesh climbs out": (edited(SPHERE, MESH.format("package://robot/../../../etc/passwd")), "leaves the", "package://"),
    "mesh climbs out sideways": (edited(SPHERE, MESH.format("../../secret.stl")), "leaves the", "package://"),
    "toolless joint": (edited('effort="150"', 'effort="0"', -1), "no effort limit", "set effort"),
    "joint that cannot move": (edited('velocity="10"', 'velocity="0"', -1), "no velocity limit", "set velocity"),
    "joint with no way back": (edited('lower="-1.0"', 'lower="0.0"', -1), "both sides of its reference", "widen"),
    "unequal legs": (edited('<mass value="12.15"/>', '<mass value="9"/>'), "not mirror images", "symmetrise = true"),
    "not XML": ("solid torso\nfacet normal 0 0 1", "not well-formed XML", "mend"),
    "empty": ("", "not well-formed XML", "mend"),
}

# what is wrong: (text, its replacement, what the message says, its remedy)
BAD_DESCRIPTION = {
    "swapped sides": (None, None, "right of the right one", "swap the joint names"),
    "locked name unknown": ("[sole]", "[posture]\nleft_knee = 0.3\n[sole]", "no movable joint 'left_knee'", "movable"),
    "roll joint unknown": ('left_hip = "left_hip"', 'left_hip = "left_hipp"', "'left_hipp'", "did you mean 'left_hip'"),
    "URDF above the folder": ('"frontal_biped.urdf"', '"../a.urdf"', "leaves its folder", "beside the URDF"),
    "absolute URDF": ('"frontal_biped.urdf"', '"/etc/passwd"', "leaves its folder", "beside the URDF"),
    "data above their folder": (
        '"frontal_biped.urdf"', '"example-robot-data:../../../pyvenv.cfg"', "leaves its folder", "without '..'"),
    "data that do not exist": (
        '"frontal_biped.urdf"', '"example-robot-data:atlas/atlas.urdf"', "has no such file", "give a path below"),
    "unknown scheme": ('"frontal_biped.urdf"', '"https://example.org/a.urdf"', "scheme 'https'", "relative to this"),
    "missing URDF": ('"frontal_biped.urdf"', '"other.urdf"', "no such URDF file", "check the path"),
    "rolled feet": (
        "[sole]",
        "[posture]\nleft_hip = 0.1\nright_hip = -0.1\n[sole]",
        "foot is rolled by 5.73 degrees",
        "cancel",
    ),
    "tilted pelvis": ("[sole]", "[base]\nrpy = [0.0, 0.3, 0.0]\n[sole]", "17.2 degrees off world X", "posture"),
    "two angles for the base": ("[sole]", "[base]\nrpy = [0.0, 0.3]\n[sole]", "three angles", "write rpy"),
    "negative armature": ("[sole]", "[armature]\nhip = -1\n[sole]", "[armature] hip = -1", "true value"),
    "symmetrise a word": ("name =", 'symmetrise = "yes"\nname =', "neither true nor false", "symmetrise = true"),
    "gait of another world": ("[sole]", "[gait]\nstride = 0.3\n[sole]", "[gait]: unknown key 'stride'", "known keys"),
}  # fmt: skip

# robots of example-robot-data that are no frontal bipeds: what the message says, its remedy
UNSUITABLE = {
    "bolt_description/robots/bolt.urdf": ("only 'FL_HAA'", "one at the ankle"),
    "cassie_description/robots/cassie_v2.sdf": ("root element is <sdf>", "<robot>"),
    "a1_description/urdf/a1.urdf": ("2 pairs of legs", "a biped has one"),
    "panda_description/urdf/panda.urdf": ("no two mirrored chains", "a left and a right leg"),
}


def refusal(capsys, arguments, folder: Path) -> str:
    """The one line that a command is refused with; the folder stays as it was."""
    before = sorted(path.name for path in folder.rglob("*"))
    assert main([str(argument) for argument in arguments]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("frontal-biped: error: ")
    assert captured.err.count("\n") == 1, captured.err
    assert sorted(path.name for path in folder.rglob("*")) == before
    return captured.err


def assert_says(message: str, *words: str) -> None:
    for word in words:
        assert re.search(re.escape(word), message, re.IGNORECASE), f"{word!r} is not in {message!r}"


def write(folder: Path, urdf: str = URDF, description: str = DESCRIPTION) -> Path:
    (folder / "frontal_biped.urdf").write_text(urdf, encoding="utf-8")
    (folder / "frontal_biped.toml").write_text(description, encoding="utf-8")
    return folder / "frontal_biped.toml"


@pytest.mark.parametrize("case", BAD_URDF)
def test_bad_urdf(case, tmp_path, capsys):
    urdf, cause, remedy = BAD_URDF[case]
    description = write(tmp_path, urdf)
    message = refusal(capsys, ["design", "--robot", description, "-o", tmp_path / "gait.json"], tmp_path)
    assert_says(message, "frontal_biped", cause, remedy)


@pytest.mark.parametrize("case", BAD_DESCRIPTION)
def test_bad_description(case, tmp_path, capsys):
    original, replacement, cause, remedy = BAD_DESCRIPTION[case]
    text = DESCRIPTION
    if original is None:
        for part in ("hip", "ankle"):
            text = text.replace(f'left_{part} = "left', f'left_{part} = "LEFT').replace(
                f'right_{part} = "right', f'right_{part} = "left'
            )
        text = text.replace("LEFT", "right")
    else:
        assert original in text
        text = text.replace(original, replacement, 1)
    description = write(tmp_path, description=text)
    message = refusal(capsys, ["design", "--robot", description, "-o", tmp_path / "gait.json"], tmp_path)
    assert_says(message, "frontal_biped.toml" if case != "missing URDF" else "other.urdf", cause, remedy)


@pytest.mark.parametrize("path", UNSUITABLE)
def test_no_description_for_what_is_no_biped(path, tmp_path, capsys):
    cause, remedy = UNSUITABLE[path]
    urdf = example_robot_data_dir() / path
    message = refusal(capsys, ["robots", "--describe", urdf, "-o", tmp_path / "robot.toml"], tmp_path)
    assert_says(message, urdf.name, cause, remedy)


def test_a_chain_of_hundreds_of_joints_is_not_searched(tmp_path, capsys):
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    link = '<link name="x{0}"><inertial><mass value="1"/>' + inertia + "</inertial></link>"
    joint = (
        '<joint name="j{0}" type="revolute"><parent link="{1}"/><child link="x{0}"/><axis xyz="1 0 0"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    )
    tail = "".join(link.format(i) + joint.format(i, f"x{i - 1}" if i else "pelvis") for i in range(900))
    write(tmp_path, edited("</robot>", tail + "</robot>"))
    began = time.perf_counter()
    message = refusal(capsys, ["robots", "--describe", tmp_path / "frontal_biped.urdf"], tmp_path)
    assert time.perf_counter() - began < PATIENCE
    assert_says(message, "904 movable joints", "fixed")


def test_huge_file(tmp_path, capsys):
    description = write(tmp_path)
    with (tmp_path / "frontal_biped.urdf").open("ab") as stream:
        stream.truncate(30_000_000_000)  # sparse: no disk is used
    message = refusal(capsys, ["design", "--robot", description], tmp_path)
    assert_says(message, "larger than", "meshes in other files")


def test_huge_description(tmp_path, capsys):
    description = write(tmp_path)
    with description.open("ab") as stream:
        stream.truncate(30_000_000_000)
    assert_says(refusal(capsys, ["design", "--robot", description], tmp_path), "larger than", ".toml file")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
@pytest.mark.parametrize("name", ["frontal_biped.toml", "frontal_biped.urdf"])
def test_a_pipe_is_not_waited_for(name, tmp_path):
    description = write(tmp_path)
    (tmp_path / name).unlink()
    os.mkfifo(tmp_path / name)
    run = subprocess.run(
        [sys.executable, "-m", "frontal_biped", "design", "--robot", description],
        capture_output=True, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert run.returncode == 2
    assert run.stderr.count("\n") == 1
    assert name in run.stderr


def test_missing_mesh_is_drawn_with_bars_and_said_in_one_line(tmp_path, caplog):
    from frontal_biped.model import load_robot
    from frontal_biped.viewer.page import SceneRecorder
    from frontal_biped.viewer.robot_shapes import draw_robot

    meshcat = pytest.importorskip("meshcat")
    robot = load_robot(write(tmp_path, edited(SPHERE, MESH.format("package://nowhere/torso.stl"))))
    recorder = SceneRecorder()
    draw_robot(meshcat.Visualizer(window=recorder)["robot"], robot)
    (record,) = caplog.records
    message = record.getMessage()
    assert "\n" not in message
    assert_says(message, "frontal_biped.urdf", "package://nowhere/torso.stl", "searched", "drawn with bars")
    drawn = {command["path"] for command in recorder.commands if command["type"] == "set_object"}
    assert "/meshcat/robot/left_hip/leg" in drawn
