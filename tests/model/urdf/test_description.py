"""Broken robot descriptions: each is refused in one line that names file, key and what would be right."""

import re

import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.model import load_robot, models_dir, robot_names
from frontal_biped.model.urdf.description import read_description

SOLE = "[sole]"

# what is wrong: (text in the file, its replacement, words the message must hold)
BROKEN = {
    "not TOML": (SOLE, "[sole", ("not valid TOML", "line", "mend")),
    "a key twice": ("inner = 0.05", "inner = 0.05\ninner = 0.05", ("not valid TOML", "mend")),
    "unknown key": ('name = "frontal_biped"', 'nome = "frontal_biped"', ("nome", "did you mean 'name'")),
    "unknown section": (SOLE, "[soles]", ("soles", "did you mean 'sole'")),
    "unknown key of the sole": ("inner = 0.05", "iner = 0.05", ("[sole]", "iner", "did you mean 'inner'")),
    "unknown key of the limits": (SOLE, "[limits]\nknee_torque = 3\n[sole]", ("[limits]", "knee_torque")),
    "name missing": ('name = "frontal_biped"', "", ("name is missing", "add name")),
    "urdf missing": ('urdf = "frontal_biped.urdf"', "", ("urdf is missing", "add urdf")),
    "name empty": ('name = "frontal_biped"', 'name = ""', ("name", "not text")),
    "urdf a number": ('urdf = "frontal_biped.urdf"', "urdf = 3", ("urdf", "not text")),
    "urdf of an unknown scheme": ('"frontal_biped.urdf"', '"ftp:a.urdf"', ("ftp", "path relative")),
    "joints missing": ("[joints]", "[posture]", ("left_ankle", "add left_ankle")),
    "a joint missing": ('right_hip = "right_hip"', "", ("[joints] right_hip is missing", "add right_hip")),
    "a joint twice": ('right_hip = "right_hip"', 'right_hip = "left_hip"', ("twice", "different joints")),
    "a joint a number": ('left_hip = "left_hip"', "left_hip = 3", ("[joints] left_hip = 3", "write")),
    "a joint not in the URDF": (
        'left_hip = "left_hip"',
        'left_hip = "left_hipp"',
        ("did you mean 'left_hip'",),
    ),
    "a joint far from any": ('left_hip = "left_hip"', 'left_hip = "qqq"', ("movable joints", "right_ankle")),
    "posture of no joint": (
        SOLE,
        "[posture]\nleft_hop = 0.1\n[sole]",
        ("[posture]", "did you mean 'left_hip'"),
    ),
    "posture out of reach": (SOLE, "[posture]\nleft_hip = 3.0\n[sole]", ("left_hip = 3", "[-1, 1]")),
    "posture a word": (SOLE, '[posture]\nleft_hip = "bent"\n[sole]', ("left_hip", "bent", "finite number")),
    "sole not a table": (SOLE, "[other]", ("other", "known keys")),
    "sole missing an end": ("inner = 0.05", "", ("[sole] inner is missing", "metres")),
    "sole NaN": ("inner = 0.05", "inner = nan", ("[sole] inner", "nan", "finite number")),
    "sole infinite": ("outer = 0.05", "outer = inf", ("[sole] outer", "inf", "finite number")),
    "sole beyond any float": ("outer = 0.05", "outer = 1" + "0" * 400, ("[sole] outer", "finite number")),
    "sole negative": ("inner = 0.05", "inner = -0.05", ("[sole] inner = -0.05", "positive")),
    "sole zero": ("outer = 0.05", "outer = 0.0", ("[sole] outer = 0", "positive")),
    "sole of no front": ("inner = 0.05", "inner = 0.05\nfront = 0.0", ("[sole] front = 0", "positive")),
    "sole's back negative": ("inner = 0.05", "inner = 0.05\nback = -0.1", ("[sole] back = -0.1", "positive")),
    "sole's front a word": ("inner = 0.05", 'inner = 0.05\nfront = "long"', ("[sole] front", "long", "finite number")),
    "sole a word": ("inner = 0.05", 'inner = "wide"', ("[sole] inner", "wide", "finite number")),
    "sole a truth value": ("inner = 0.05", "inner = true", ("[sole] inner", "True", "finite number")),
    "ankle below the sole": (
        "ankle_height = 0.0",
        "ankle_height = -0.1",
        ("ankle_height = -0.1", "negative"),
    ),
    "torque limit negative": (
        SOLE,
        "[limits]\nhip_torque = -3\n[sole]",
        ("[limits] hip_torque = -3", "positive"),
    ),
    "torque limit zero": (
        SOLE,
        "[limits]\nankle_torque = 0\n[sole]",
        ("[limits] ankle_torque = 0", "positive"),
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_description(model_files, case):
    _, description = model_files
    original, replacement, words = BROKEN[case]
    text = description.read_text(encoding="utf-8")
    assert original in text
    description.write_text(text.replace(original, replacement, 1), encoding="utf-8")
    with pytest.raises(RobotError) as caught:
        load_robot(description)
    message = str(caught.value)
    assert "\n" not in message
    for word in ("frontal_biped.toml", *words):
        assert re.search(re.escape(word), message, re.IGNORECASE), f"{word!r} is not in {message!r}"


def test_missing_file(tmp_path):
    with pytest.raises(RobotError, match=r"robot\.toml: no such file; check the path"):
        load_robot(tmp_path / "robot.toml")


def test_folder_instead_of_file(tmp_path):
    with pytest.raises(RobotError, match=r"\.toml"):
        load_robot(tmp_path)


def test_empty_file(tmp_path):
    (tmp_path / "robot.toml").write_text("")
    with pytest.raises(RobotError, match=r"robot\.toml: .*missing; add"):
        load_robot(tmp_path / "robot.toml")


def test_not_text(tmp_path):
    (tmp_path / "robot.toml").write_bytes(b'name = "\xe9"')
    with pytest.raises(RobotError, match=r"robot\.toml: not valid TOML"):
        load_robot(tmp_path / "robot.toml")


def test_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(RobotError, match="did you mean 'frontal_biped'"):
        load_robot("frontal_bipd")
    with pytest.raises(RobotError, match="frontal_biped_low_torso"):
        load_robot("xyz")


def test_packaged_robots_are_listed_and_load():
    names = robot_names()
    assert {"frontal_biped", "frontal_biped_low_torso"} <= set(names)
    for name in names:
        assert read_description(models_dir() / f"{name}.toml").name == name


def test_limits_override_the_urdf(model_files):
    _, description = model_files
    text = description.read_text(encoding="utf-8")
    limited = text.replace(SOLE, "[limits]\nankle_torque = 30\nhip_torque = 70.5\n[sole]")
    description.write_text(limited, encoding="utf-8")
    assert list(load_robot(description).max_torque) == [30.0, 70.5, 70.5, 30.0]


def test_fingerprint_follows_what_shapes_the_model(model_files, biped):
    urdf, description = model_files
    assert load_robot(description).fingerprint == biped.fingerprint  # wherever the files lie
    text = description.read_text(encoding="utf-8")
    description.write_text(text + "\n# a comment\n", encoding="utf-8")
    assert load_robot(description).fingerprint == biped.fingerprint
    description.write_text(text.replace("inner = 0.05", "inner = 0.04"), encoding="utf-8")
    shorter = load_robot(description).fingerprint
    assert shorter != biped.fingerprint
    urdf.write_text(urdf.read_text().replace('value="36.0"', 'value="35.0"'))
    assert load_robot(description).fingerprint not in (shorter, biped.fingerprint)
