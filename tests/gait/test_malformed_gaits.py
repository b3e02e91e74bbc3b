"""Gait files with one thing wrong, thousands of them: each is read, or refused in one short line."""

import copy
import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frontal_biped.cli import main
from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait.file import load_any_gait, load_gait, save_gait
from frontal_biped.gait.ranges import GAIT, MOST_COEFFICIENTS, SPECIFICATION
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model import models_dir

DATA = Path(__file__).parents[1] / "data"
CONTENT = json.loads((DATA / "gait.json").read_text(encoding="utf-8"))
"""Of version 1: one step."""

SIDEWAYS = json.loads((DATA / "sideways.gait.json").read_text(encoding="utf-8"))
"""Of version 2: two steps."""

LONGEST_LINE = 1500
"""Characters of a complaint; a path may have some hundreds."""

VALUES = [
    0, -0.0, 1, -1, 1e-300, -1e-300, 1e-9, 999.0, 1e6, 1e12, 1e308, -1e308, float("nan"), float("inf"), float("-inf"),
    None, True, False, "", "text", "a\nb", "\x1b[31m", "\ud800", "\u202e", "\0", [], {}, [1], [[1]], {"a": 1},
    10**399, 10**400, 2**63, -(2**63), 3.2, -3.2, "9" * 5000, [0] * 1000, [[0] * MOST_COEFFICIENTS] * 3,
    [[0] * (MOST_COEFFICIENTS + 1)] * 3, [[0] * 4] * 3,
]  # fmt: skip


def places(content, before=()):
    """Every place in a file: keys and indices that lead there."""
    parts = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, part in parts:
        yield (*before, key)
        yield from places(part, (*before, key))


PLACES = list(places(CONTENT))


def changed(place, value, of=CONTENT):
    content = copy.deepcopy(of)
    part = content
    for key in place[:-1]:
        part = part[key]
    part[place[-1]] = value
    return content


def read_or_refused(path, text) -> str:
    """What is said; "" of a file that is accepted."""
    path.write_text(text, encoding="utf-8")
    try:
        save_gait(load_any_gait(path), path)
        repr(load_any_gait(path))
    except GaitFileError as error:
        message = str(error)
        assert message.startswith(str(path))
        assert message.isprintable()
        assert len(message) < LONGEST_LINE
        return message
    return ""


values = st.sampled_from(VALUES) | st.floats()
one_change = st.one_of(
    st.builds(changed, st.sampled_from(PLACES), values),
    st.builds(changed, st.sampled_from(list(places(SIDEWAYS))), values, st.just(SIDEWAYS)),
)
quiet = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=150)
@given(one_change)
def test_one_value_changed(tmp_path, content):
    read_or_refused(tmp_path / "gait.json", json.dumps(content))


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@settings(quiet, max_examples=5000)
@given(one_change)
def test_many_values_changed(tmp_path, content):
    read_or_refused(tmp_path / "gait.json", json.dumps(content))


@pytest.mark.slow
@settings(quiet, max_examples=2000)
@given(st.data())
def test_bytes_changed(tmp_path, data):
    text = bytearray(json.dumps(data.draw(st.sampled_from([CONTENT, SIDEWAYS]))).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        text[data.draw(st.integers(0, len(text) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "gait.json"
    path.write_bytes(bytes(text))
    try:
        load_any_gait(path)
    except GaitFileError as error:
        assert str(error).isprintable() and len(str(error)) < LONGEST_LINE


REFUSED = {
    "friction as text": (("specification", "friction"), "high", "friction: 'high' is not a finite number"),
    "no friction": (("specification", "friction"), None, "friction: None is not a finite number"),
    "friction NaN": (("specification", "friction"), float("nan"), "friction: nan"),
    "a normal force beyond everything": (("specification", "min_normal_force"), 1e308, "min_normal_force = 1e+308"),
    "a phase of ten turns": (("rising", "beta_end"), 60.0, "rising.beta_end = 60 is above 0 rad"),
    "an orbit without energy": (("orbit", "zeta_f_star"), 0.0, "orbit.zeta_f_star = 0 must be positive"),
    "a step of no time": (("orbit", "step_duration"), -0.0, "orbit.step_duration = -0 must be positive"),
    "a negative multiplier": (("orbit", "multiplier"), -0.5, "orbit.multiplier = -0.5 must be positive"),
    "a cost beyond everything": (("orbit", "cost"), 1e300, "orbit.cost = 1e+300 is above 1e+18"),
    "a width of kilometres": (("step_width",), 1e4, "step_width = 10000 is above 10 m"),
    "a joint that spins": (("rising", "joint_bezier", 0, 0), 1e5, "rising.joint_bezier = 100000 is above 1000 rad"),
    "pressure beyond the horizon": (("falling", "fri_bezier", 1), -1e5, "falling.fri_bezier = -100000 is below -1000"),
    "degree 31": (("rising", "joint_bezier"), [[0.0] * 32] * 3, "32 coefficients, more than 31"),
    "40000 coefficients": (("falling", "fri_bezier"), [0.0] * 40_000, "40000 coefficients, more than 31"),
    "a name of two lines": (("robot", "name"), "a\nb", "robot.name = 'a\\nb' is not one line"),
    "a name that a terminal obeys": (("robot", "name"), "\x1b[2J", "robot.name = '\\x1b[2J' is not one line"),
    "a long name": (("robot", "name"), "x" * 5000, "is not one line of at most 4096"),
    "half a character": (("robot", "name"), "\ud800", "surrogates not allowed"),
    "provenance that is not finite": (("provenance", "seed"), float("inf"), "provenance holds inf"),
    "provenance without end": (("provenance", "seed"), [0] * 20_000, "more than 10000 values"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(tmp_path, case):
    place, value, words = REFUSED[case]
    assert words in read_or_refused(tmp_path / "gait.json", json.dumps(changed(place, value)))


def test_provenance_may_be_any_json(tmp_path):
    content = changed(("provenance", "mine"), {"by": ["a\nb", 1, None, {"deep": [[-1.5e300]]}]})
    assert read_or_refused(tmp_path / "gait.json", json.dumps(content)) == ""


OF_A_DOUBLE_SUPPORT = {"double_support", "setting_off", "pressure_margin"}
"""Fields of another kind of gait, see `test_support_file`."""


@pytest.mark.parametrize("key", [key for key in GAIT if key not in OF_A_DOUBLE_SUPPORT])
def test_ends_of_the_ranges_belong_to_them(tmp_path, key):
    place = next(place for place in PLACES if place[-1] == key and place[0] != "specification")
    for value in (GAIT[key].low, GAIT[key].high):
        numbers = [value] * 6 if key == "fri_bezier" else [[value] * 6] * 3 if key == "joint_bezier" else value
        said = read_or_refused(tmp_path / "gait.json", json.dumps(changed(place, numbers)))
        assert said == "" or "beta_start must be" in said


@pytest.mark.parametrize("key", SPECIFICATION)
def test_numbers_of_a_specification_beyond_their_ranges(key):
    allowed = SPECIFICATION[key]
    size = {"step_duration": 2, "step_width": 2, "double_support": 2, "max_torque": 4}.get(key, 0)
    for value in (2.0 * allowed.high, 0.5 * allowed.low if allowed.low > 0.0 else -1e-9):
        with pytest.raises(SpecificationError, match=key) as caught:
            GaitSpecification(**{key: (value,) * size if size else value})
        assert str(caught.value).isprintable()


@pytest.mark.parametrize("path", sorted(models_dir().glob("*.gait.json")), ids=lambda path: path.name)
def test_packaged_gaits_are_well_within(path):
    assert load_gait(path).rising.degree < MOST_COEFFICIENTS


@pytest.mark.parametrize("command", ["analyze", "simulate"])
def test_a_device_is_not_a_gait(command, capsys):
    told = "not a file but a device or a pipe; write it to a .json file first"
    assert main([command, "/dev/zero"]) == 2
    assert capsys.readouterr().err == f"frontal-biped: error: /dev/zero: {told}\n"
