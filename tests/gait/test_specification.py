"""Gait specifications: defaults, and every bad key, type or range refused by key and value."""

import math

import pytest

from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait import GaitSpecification, read_specification

# (key, value, words of the message besides the key)
BAD = [
    ("degree", 2, "2"),
    ("degree", 13, "13"),
    ("degree", 5.0, "5.0"),
    ("degree", "five", "five"),
    ("degree", True, "True"),
    ("degree", (5, 5), "[5, 5]"),
    ("degree", (5,), "[5]"),
    ("degree", (5, 5, 2), "2"),
    ("degree", (5, 5, 5.0), "5.0"),
    ("max_multiplier", 1.0, "(0, 1)"),
    ("max_multiplier", 0.0, "(0, 1)"),
    ("min_energy_margin", -0.1, "-0.1"),
    ("max_reversal_shift", 2.0, "2"),
    ("cop_margin_x", -0.01, "-0.01"),
    ("cop_margin_x", True, "True"),
    ("yaw_friction", 0.0, "(0, inf)"),
    ("yaw_friction", math.inf, "inf"),
    ("fri_degree", 0, "0"),
    ("fri_degree", 13, "13"),
    ("fri_degree", 1.5, "1.5"),
    ("seed", -1, "-1"),
    ("seed", 0.5, "0.5"),
    ("friction", 0.0, "positive"),
    ("friction", -0.6, "-0.6"),
    ("friction", math.nan, "nan"),
    ("friction", math.inf, "inf"),
    ("friction", "high", "high"),
    ("friction", True, "True"),
    ("friction", None, "None"),
    ("friction", 10**400, "finite number"),
    ("min_normal_force", -0.1, "-0.1"),
    ("fri_margin", -0.001, "-0.001"),
    ("swing_clearance", -0.01, "-0.01"),
    ("touchdown_speed", -0.05, "-0.05"),
    ("touchdown_speed", math.nan, "nan"),
    ("min_phase_range", 0.0, "positive"),
    ("min_phase_range", -0.02, "-0.02"),
    ("step_duration", (0.8, 0.4), "[0.8, 0.4]"),
    ("step_duration", (0.0, 0.4), "[0.0, 0.4]"),
    ("step_duration", (-0.1, 0.4), "[-0.1, 0.4]"),
    ("step_duration", 0.5, "0.5"),
    ("step_duration", (0.5,), "(0.5,)"),
    ("step_duration", (0.4, 0.6, 0.8), "0.6"),
    ("step_duration", ("a", "b"), "'a'"),
    ("step_duration", (0.4, math.nan), "nan"),
    ("step_width", (0.3, 0.2), "[0.3, 0.2]"),
    ("step_width", (0.0, 0.2), "[0.0, 0.2]"),
    ("step_width", "wide", "wide"),
    ("double_support", (0.2, 0.1), "[0.2, 0.1]"),
    ("double_support", (0.0, 0.1), "[0.0, 0.1]"),
    ("double_support", 0.1, "0.1"),
    ("double_support", (0.1, math.inf), "inf"),
    ("double_support", (0.1, 3.0), "above 2 s"),
    ("max_pelvis_roll", 0.0, "0"),
    ("max_pelvis_roll", -0.1, "-0.1"),
    ("max_pelvis_roll", 5.0, "radians"),
    ("max_pelvis_roll", math.nan, "nan"),
    ("max_pelvis_roll", "level", "level"),
    ("max_torque", (1.0, 2.0, 3.0), "(1.0, 2.0, 3.0)"),
    ("max_torque", (1.0, 2.0, 3.0, 0.0), "0.0"),
    ("max_torque", (1.0, 2.0, 3.0, math.inf), "inf"),
    ("max_torque", 100.0, "100.0"),
]


@pytest.mark.parametrize(("key", "value", "word"), BAD, ids=lambda part: str(part)[:24])
def test_bad_value(key, value, word):
    for make in (lambda: GaitSpecification(**{key: value}), lambda: GaitSpecification.from_dict({key: value}, "S")):
        with pytest.raises(SpecificationError) as caught:
            make()
        message = str(caught.value)
        assert key in message
        assert word in message
        assert "\n" not in message


def test_unknown_key_is_answered_with_the_nearest():
    with pytest.raises(SpecificationError, match=r"here: unknown key 'frictions'; did you mean 'friction'\?"):
        GaitSpecification.from_dict({"frictions": 0.5}, "here")
    with pytest.raises(SpecificationError, match=r"unknown key 'zzz'; known keys: .*friction"):
        GaitSpecification.from_dict({"zzz": 0.5})


def test_defaults():
    assert GaitSpecification() == GaitSpecification(
        degree=5, fri_degree=3, friction=0.6, min_normal_force=0.1, fri_margin=0.005, swing_clearance=0.01,
        touchdown_speed=0.05, min_phase_range=0.02, step_duration=(0.4, 0.8), step_width=(0.15, 0.35),
        max_pelvis_roll=None, max_torque=None, max_multiplier=None, min_energy_margin=None, max_reversal_shift=None,
        seed=0, cop_margin_x=None, yaw_friction=None,
    )  # fmt: skip


def test_there_and_back_as_a_dictionary():
    specification = GaitSpecification(
        degree=6, friction=0.4, step_width=(0.2, 0.2), max_pelvis_roll=0.1, max_torque=(1, 2, 3, 4)
    )
    table = specification.as_dict()
    assert table["max_torque"] == [1.0, 2.0, 3.0, 4.0]
    assert GaitSpecification.from_dict(table) == specification
    assert "max_pelvis_roll" not in GaitSpecification().as_dict()


def test_double_support_and_travel_do_not_go_together():
    with pytest.raises(SpecificationError, match=r"double_support = \[0.1, 0.2\] and travel = 0.1 .*leave one"):
        GaitSpecification(double_support=(0.1, 0.2), travel=0.1)


class TestFile:
    def test_every_key(self, tmp_path):
        path = tmp_path / "gait.toml"
        path.write_text(
            "degree = 6\nfri_degree = 2\nfriction = 0.5\nmin_normal_force = 0.2\nfri_margin = 0.01\n"
            "swing_clearance = 0.02\ntouchdown_speed = 0.1\nmin_phase_range = 0.03\nstep_duration = [0.5, 0.6]\n"
            "step_width = [0.2, 0.3]\nmax_pelvis_roll = 0.1\nmax_foot_rotation = 0.3\n"
            "max_torque = [40, 90, 90, 40]\nseed = 7\n"
            "max_multiplier = 0.7\nmin_energy_margin = 0.4\nmax_reversal_shift = 0.002\n"
            "cop_margin_x = 0\nyaw_friction = 0.5\n"
        )
        assert read_specification(path) == GaitSpecification(
            6, 2, 0.5, 0.2, 0.01, 0.02, 0.1, 0.03, (0.5, 0.6), (0.2, 0.3), 0.1, 0.3, (40.0, 90.0, 90.0, 40.0),
            0.7, 0.4, 0.002, 7, 0.0, 0.5,
        )  # fmt: skip

    def test_degrees_of_the_outputs(self, tmp_path):
        path = tmp_path / "gait.toml"
        path.write_text("degree = [6, 5, 4]\n")
        specification = read_specification(path)
        assert specification.degrees == (6, 5, 4)
        assert GaitSpecification.from_dict(specification.as_dict()) == specification
        assert GaitSpecification(degree=6).degrees == (6, 6, 6)

    def test_empty_file_means_defaults(self, tmp_path):
        path = tmp_path / "gait.toml"
        path.write_text("")
        assert read_specification(path) == GaitSpecification()

    @pytest.mark.parametrize(
        ("text", "word"),
        [
            ("friction = -1", "friction = -1"),
            ("friction = nan", "nan"),
            ("frction = 0.5", "did you mean 'friction'"),
            ("friction", "not valid TOML"),
            ("[friction]\nmu = 1", "friction"),
            ("step_width = [0.3]", "step_width"),
            ("step_width = [[0.1], 0.2]", "step_width"),
        ],
    )
    def test_bad_file(self, tmp_path, text, word):
        path = tmp_path / "gait.toml"
        path.write_text(text)
        with pytest.raises(SpecificationError) as caught:
            read_specification(path)
        assert "gait.toml" in str(caught.value)
        assert word in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_missing_file(self, tmp_path):
        with pytest.raises(SpecificationError, match=r"gait\.toml: no such file; check the path"):
            read_specification(tmp_path / "gait.toml")


def test_a_robot_may_bring_the_specification_that_suits_it(tmp_path, biped):
    """The ``[gait]`` table of a description; without one, the defaults; errors name the file and the table."""
    from frontal_biped.gait import default_specification
    from frontal_biped.model import load_robot, models_dir

    assert default_specification(biped) == GaitSpecification()
    (tmp_path / "frontal_biped.urdf").write_bytes((models_dir() / "frontal_biped.urdf").read_bytes())
    text = (models_dir() / "frontal_biped.toml").read_text(encoding="utf-8")
    path = tmp_path / "mine.toml"
    path.write_text(text + "\n[gait]\nfriction = 0.4\nstep_width = [0.2, 0.3]\n", encoding="utf-8")
    mine = load_robot(path)
    assert default_specification(mine) == GaitSpecification(friction=0.4, step_width=(0.2, 0.3))
    assert mine.fingerprint == biped.fingerprint  # it does not shape the model
    path.write_text(text + '\n[gait]\nfriction = "rough"\n', encoding="utf-8")
    with pytest.raises(SpecificationError, match=r"mine\.toml: \[gait\]: friction"):
        default_specification(load_robot(path))
