"""URDFs and descriptions with something wrong: each is read, or refused in one short line, and nothing else is said."""

import json
import re
import time
import tomllib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frontal_biped.cli import main
from frontal_biped.exceptions import RobotError
from frontal_biped.model import load_robot, models_dir
from frontal_biped.model.urdf.description import read_description
from frontal_biped.model.urdf.proposal import propose_description, propose_posture

TABLE = (models_dir() / "frontal_biped.urdf").read_text(encoding="utf-8")
MINI = (Path(__file__).parents[2] / "data" / "mini.urdf").read_text(encoding="utf-8")
DESCRIPTION = (models_dir() / "frontal_biped.toml").read_text(encoding="utf-8")

LONGEST_LINE = 1500
PATIENCE = 20.0  # [s]

NUMBERS = [
    "0", "-0", "1e300", "-1e300", "1e308", "1e-300", "1e-320", "1e400", "-1", "1e6", "1e12", "1e-9", "nan", "inf",
    "-inf", "0x10", "3_6.0", "5.", "5.0 ", ".5", "+3", "1e", "", " ", "1,0", "９", "9" * 5000, "0.5 0.5", "1&#10;",
    "1.7976931348623157e308", "1d0", "true", "1e150", "1e-20",
]  # fmt: skip
NAMES = [
    "", "world", "universe", "root_joint", "pelvis", "left_foot", "a&#10;b", "a&#x9b;2Jb", "&quot;", "ü", "🦿",
    "x" * 10_000, "a b", "&lt;x&gt;", "&#x202e;a", "left_hip", "a = 1", "%s",
]  # fmt: skip
ELEMENTS = [
    "<?pi x?>", "<![CDATA[x]]>", "<mimic/>", '<mimic joint="nowhere"/>', "<dynamics/>", "<limit/>", "<axis/>",
    '<axis xyz="1e-200 0 0"/>', "<visual/>", "<collision><geometry/></collision>", "<material/>", "<inertial/>",
    "<collision><geometry><box/></geometry></collision>", '<material name="m"><color rgba="x"/></material>',
    '<collision><geometry><axis/><sphere radius="1"/></geometry></collision>', "<safety_controller/>", "text",
    "<link/>", '<collision><geometry><mesh filename="nowhere.stl"/></geometry></collision>',
    '<joint name="z" type="fixed"/>',
]  # fmt: skip


@st.composite
def broken(draw, text):
    """A URDF in which a number, a name or an element is another one."""
    kind = draw(st.integers(0, 3))
    pattern = (
        r'(?:value|i[xyz][xyz]|lower|upper|effort|velocity|radius|length)="([^"]*)"', r'(?:xyz|rpy|size)="([^"]*)"',
        r'(?:name|link|type)="([^"]*)"', r">()",
    )[kind]  # fmt: skip
    found = draw(st.sampled_from(list(re.finditer(pattern, text))))
    new = draw(st.sampled_from((NUMBERS, NUMBERS, NAMES, ELEMENTS)[kind]))
    if kind == 1:
        words = found[1].split()
        words[draw(st.integers(0, len(words) - 1))] = new
        new = " ".join(words)
    return text[: found.start(1)] + new + text[found.end(1) :]


def used_or_refused(use, urdf, text):
    """Call a function of the URDF; it may refuse it."""
    urdf.write_text(text, encoding="utf-8")
    began = time.process_time()
    try:
        use()
    except RobotError as error:
        assert str(error).isprintable()
        assert len(str(error)) < LONGEST_LINE
    assert time.process_time() - began < PATIENCE


def loaded(urdf):
    def use():
        description = urdf.with_name("robot.toml")
        description.write_text(DESCRIPTION.replace("frontal_biped.urdf", urdf.name), encoding="utf-8")
        repr(load_robot(description))

    return use


def proposed(urdf):
    def use():
        proposal = propose_description(urdf)
        tomllib.loads(proposal.text)
        assert all(line.isprintable() for line in (*proposal.found, *proposal.undecided, *proposal.changed))

    return use


quiet = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=60)
@given(broken(TABLE))
def test_one_thing_broken(tmp_path, capfd, text):
    used_or_refused(loaded(tmp_path / "robot.urdf"), tmp_path / "robot.urdf", text)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=2000)
@given(broken(TABLE))
def test_many_things_broken(tmp_path, capfd, text):
    used_or_refused(loaded(tmp_path / "robot.urdf"), tmp_path / "robot.urdf", text)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=150)
@given(broken(MINI))
def test_described_with_one_thing_broken(tmp_path, capfd, text):
    used_or_refused(proposed(tmp_path / "robot.urdf"), tmp_path / "robot.urdf", text)
    assert capfd.readouterr() == ("", "")


def every(attributes, value):
    return re.sub(rf'\b({attributes})="[^"]*"', rf'\1="{value}"', MINI)


def star(count, kind):
    """So many more limbs of one joint each."""
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    ends = '<parent link="body"/><child link="l{0}"/>'
    limb = '<link name="l{0}"/><joint name="k{0}" type="' + kind + '">' + ends + limit + "</joint>"
    return MINI.replace("</robot>", "".join(limb.format(i) for i in range(count)) + "</robot>")


FOOT = '<link name="left_foot">'
BOX = '<collision><geometry><box size="1 1 1"/></geometry></collision>'

# what is wrong: (text, words of the complaint)
REFUSED = {
    "no masses": (every("value", "0"), "weighs 0 kg.*give its links an <inertial>"),
    "masses of nothing": (every("value", "1e-300"), "weighs .* kg.*masses"),
    "a mass in the way TOML writes it": (MINI.replace('"24.0"', '"2_4.0"'), "value='2_4.0' is not a finite number"),
    "a mass beyond everything": (MINI.replace('"24.0"', '"1e300"'), "'body': value='1e300' is beyond 1e.06"),
    "a length beyond everything": (MINI.replace('"0 0.09 0"', '"0 1e300 0"'), "xyz='0 1e300 0' is beyond 1e.06"),
    "an inertia beyond everything": (MINI.replace('"1.1"', '"1e300"'), "ixx='1e300' is beyond 1e.12"),
    "a number of 5000 digits": (MINI.replace('"24.0"', f'"{"9" * 5000}"'), "is not a finite number"),
    "an axis of nothing": (MINI.replace('"1 0 0"', '"1e-200 0 0"', 1), "its axis is zero"),
    "a name of 10000 letters": (MINI.replace('"body"', f'"{"x" * 10_000}"'), "a name of 10000 characters; shorten"),
    "a mimic of nothing": (MINI.replace("</joint>", "<mimic/></joint>", 1), "its <mimic> names no joint"),
    "dynamics of nothing": (MINI.replace("</joint>", "<dynamics/></joint>", 1), "no damping and no friction"),
    "a joint that Pinocchio has too": (MINI.replace('"left_knee_j"', '"root_joint"'), "'root_joint'.*rename it"),
    "a version to come": (MINI.replace("<robot ", '<robot version="9.0" '), "Invalid 'version'"),
    "100000 links": ("<robot name='x'>" + '<link name="a"/>' * 100_000 + "</robot>", "100000 links; at most 1000"),
    "60000 joints": (star(1, "fixed").replace("</robot>", "<joint/>" * 60_000 + "</robot>"), "joints; at most 1000"),
    "1001 shapes": (MINI.replace(FOOT, FOOT + BOX * 1001), "shapes; at most 1000"),
    "40 limbs": (star(40, "revolute"), "chains of movable joints, at most 25"),
    "250 limbs": (star(250, "revolute"), "movable joints, at most 200"),
    "50000 shapes of nothing": (MINI.replace(FOOT, FOOT + "<visual/>" * 50_000), "shapes; at most 1000"),
    "UTF-16": (MINI.encode("utf-16"), "not UTF-8 text"),
    "latin-1": (MINI.replace("mini", "mïni").encode("latin-1"), "not UTF-8 text"),
    "a zero": (MINI.replace("mini", "mi\0ni"), "not well-formed XML"),
    "an escape sequence": (MINI.replace('"body"', '"&#27;[2J"'), "not well-formed XML"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_describe_refuses_in_one_line(tmp_path, capfd, case):
    text, complaint = REFUSED[case]
    urdf = tmp_path / "robot.urdf"
    urdf.write_bytes(text if isinstance(text, bytes) else text.encode())
    began = time.process_time()
    assert main(["robots", "--describe", str(urdf)]) == 2
    assert time.process_time() - began < PATIENCE
    out, error = capfd.readouterr()
    assert out == ""
    assert error.startswith(f"frontal-biped: error: {urdf}") and error.count("\n") == 1
    assert len(error) < LONGEST_LINE and error.strip().isprintable()
    assert re.search(complaint, error), error


# what is odd: text of a URDF that is read nevertheless
READ = {
    "a byte order mark": "\ufeff" + MINI,
    "carriage returns": MINI.replace("\n", "\r\n"),
    "a processing instruction": MINI.replace(FOOT, "<?pi x?>" + FOOT),
    "CDATA": MINI.replace(FOOT, "<![CDATA[<link/>]]>" + FOOT),
    "20000 materials": MINI.replace("</robot>", '<material name="a"/>' * 20_000 + "</robot>"),
    "a colour that is none": MINI.replace("</robot>", '<material name="a"><color rgba="x"/></material></robot>'),
    "something before a box": MINI.replace('<geometry><box size="0.2 0.1', '<geometry><axis/><box size="0.2 0.1'),
    "a box without a size": MINI.replace("</link>", "<collision><geometry><box/></geometry></collision></link>"),
    "a fixed joint of the root's name": MINI.replace(
        "</robot>",
        '<link name="base"/><joint name="root_joint" type="fixed"><parent link="base"/><child link="body"/></joint>'
        "</robot>",
    ),
    "a link of Pinocchio's": MINI.replace('"body"', '"universe"'),
    "a name of two lines": MINI.replace("left_hip_roll_j", "left_hip&#10;roll_j"),
    "a name that a terminal obeys": MINI.replace("left_hip_roll_j", "left_hip&#x9b;2J"),
    "a name beyond the first plane": MINI.replace("left_hip_roll_j", "left_🦿"),
    "a name with quotes": MINI.replace("left_hip_roll_j", "left_&quot;'\\"),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("case", READ)
def test_described_as_if_nothing_were(tmp_path, capfd, case):
    """The proposal is TOML, nothing in it is left to settle, and the robot is loaded from it."""
    urdf, description = tmp_path / "robot.urdf", tmp_path / "robot.toml"
    urdf.write_text(READ[case], encoding="utf-8", newline="")
    assert main(["robots", "--describe", str(urdf), "-o", str(description)]) == 0
    out, error = capfd.readouterr()
    assert error == ""
    assert out.replace("\n", "").isprintable()
    robot = load_robot(description)
    assert robot.mass == pytest.approx(44.6)
    assert robot.sole == pytest.approx((-0.05, 0.05))


def test_a_file_whose_name_no_description_could_write(tmp_path, capfd):
    urdf = tmp_path / "a\tb.urdf"
    urdf.write_text(MINI, encoding="utf-8")
    assert main(["robots", "--describe", str(urdf)]) == 2
    assert "rename it" in capfd.readouterr().err


VALUES = [
    "0", "-0.0", "1", "-1", "1e300", "-1e300", "1e400", "nan", "inf", "-inf", "9223372036854775808", "9" * 5000,
    f"0x{'f' * 6000}", "true", "1979-05-27", "07:32:00", "1979-05-27T07:32:00Z", '""', '"x"', '"a\\nb"', '"\\u0000"',
    '"\\u001b[2J"', '"' + "x" * 5000 + '"', "[]", "[1]", "[nan, 0, 0]", "[1, 2, 3]", "[[1]]", "{}", "{a = 1}", "[{}]",
    "[" * 60 + "]" * 60, "[1979-05-27]",
]  # fmt: skip
PLACES = [
    "name", "urdf", "symmetrise", "virtual_legs", "joints", "joints.left_hip", "sole", "sole.inner", "sole.outer",
    "limits", "sole.ankle_height", "sole.front", "limits.ankle_torque", "armature.other", "base.rpy",
    "posture.left_hip", 'posture."a\\nb"', 'posture."\\u0000"', "gait.friction", "gait.step_width",
    'gait."\\u001b"',
    '"\\u001b[2J"',
]  # fmt: skip


@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=100)
@given(st.sampled_from(PLACES), st.sampled_from(VALUES))
def test_descriptions(tmp_path, place, value):
    """Every value of TOML at every place of a description, and a posture proposed where it is one."""
    (tmp_path / "frontal_biped.urdf").write_text(TABLE, encoding="utf-8")
    lines = [f"{place} = {value}"]
    for name, content in tomllib.loads(DESCRIPTION).items():
        parts = {f"{name}.{part}": number for part, number in content.items()} if isinstance(content, dict) else {}
        for told, number in (parts or {name: content}).items():
            if place not in (told, name):
                lines.append(f"{told} = {json.dumps(number)}")
    path = tmp_path / "robot.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    for use in (read_description, load_robot, lambda path: tomllib.loads(propose_posture(path).text)):
        try:
            use(path)
        except RobotError as error:
            assert str(error).isprintable() and len(str(error)) < LONGEST_LINE


def test_a_posture_for_joints_that_are_not_there(tmp_path, capfd):
    (tmp_path / "frontal_biped.urdf").write_text(TABLE, encoding="utf-8")
    path = tmp_path / "robot.toml"
    path.write_text(DESCRIPTION.replace('left_hip = "left_hip"', 'left_hip = "left_hop"'), encoding="utf-8")
    for task in ("--posture", "--bend"):
        assert main(["robots", task, str(path)]) == 2
        assert "no movable joint 'left_hop'; did you mean 'left_hip'?" in capfd.readouterr().err
