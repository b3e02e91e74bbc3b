"""Files of gaits with a finite double support: written, read strictly, told apart from the others."""

import copy
import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from frontal_biped.exceptions import GaitFileError
from frontal_biped.gait.file import load_any_gait, load_gait
from frontal_biped.gait.gait import Gait
from frontal_biped.gait.given import any_gait_of
from frontal_biped.gait.ranges import GAIT
from frontal_biped.gait.sideways import SidewaysGait
from frontal_biped.gait.support_certificate import certify_support_gait
from frontal_biped.gait.support_file import load_filed_gait, load_support_gait, save_support_gait, support_gait_to_dict
from frontal_biped.gait.support_gait import SupportGait

DATA = Path(__file__).parents[1] / "data"
FILE = DATA / "support.gait.json"
"""Of the Table I robot, double support of 0.1 to 0.2 s, ranges of beta of at least 0.04 rad."""

CONTENT = json.loads(FILE.read_text(encoding="utf-8"))

LONGEST_LINE = 1500
"""Characters of a complaint; a path may have some hundreds."""

STORED = 1e-9
"""Relative difference of stored numbers from new ones: versions of NumPy and processors add up in another order."""

VALUES = [0, -1, 1e-300, 999.0, 1e308, float("nan"), float("inf"), None, True, "", "a\nb", [], {}, [1], [[1]], 10**400]


@pytest.fixture
def written(tmp_path):
    """Writes a changed file: the place, by its keys, gets a value, or where there is none goes."""

    def write(place, *value):
        content = copy.deepcopy(CONTENT)
        part = content
        for key in place[:-1]:
            part = part[key]
        if value:
            part[place[-1]] = value[0]
        else:
            del part[place[-1]]
        path = tmp_path / "gait.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        return path

    return write


def test_saved_again_byte_for_byte(tmp_path):
    save_support_gait(load_support_gait(FILE), tmp_path / "gait.json")
    assert (tmp_path / "gait.json").read_bytes() == FILE.read_bytes()


def test_every_field_is_named_in_the_docstring():
    import frontal_biped.gait.support_file as module

    step = CONTENT["support_step"]
    assert [key for key in (*step, *step["orbit"], "support_step") if key not in module.__doc__] == []


def test_is_certified_and_stores_its_own_orbit(biped):
    certificate = certify_support_gait(biped, load_support_gait(FILE))
    assert certificate.holds
    assert certificate.stored_orbit < STORED


@pytest.mark.parametrize("number", ["step_duration", "double_support", "cost"])
def test_a_stored_number_that_is_not_the_orbits_refutes(biped, number):
    gait = load_support_gait(FILE)
    other = replace(gait, numbers=gait.numbers._replace(**{number: 1.001 * getattr(gait.numbers, number)}))
    assert not certify_support_gait(biped, other).holds


def test_told_apart():
    assert isinstance(load_filed_gait(FILE), SupportGait)
    assert isinstance(load_filed_gait(DATA / "sideways.gait.json"), SidewaysGait)
    assert isinstance(load_filed_gait(DATA / "gait.json"), Gait)
    assert isinstance(load_filed_gait("g1"), Gait)
    with pytest.raises(GaitFileError, match=r"with impacts; design one with double_support"):
        load_support_gait("g1")
    for refused in (load_gait, load_any_gait, any_gait_of):
        with pytest.raises(GaitFileError, match=r"finite double support; simulate or analyze it"):
            refused(FILE)
    with pytest.raises(GaitFileError, match=r"finite double support; `stand_walk_stand`"):
        any_gait_of(load_support_gait(FILE))


def test_one_without_numbers_is_not_written(tmp_path):
    with pytest.raises(GaitFileError, match="write one of `design_support_gait`"):
        save_support_gait(replace(load_support_gait(FILE), numbers=None), tmp_path / "gait.json")
    assert list(tmp_path.iterdir()) == []


REFUSED = {
    "another version": (("version",), 1, "support_step"),
    "a version to come": (("version",), 3, '"version" is 3'),
    "steps besides": (("steps",), [], "unknown field 'steps'"),
    "a step that is none": (("support_step",), 1, "'support_step' is missing or not an object"),
    "a falling phase": (("support_step", "falling"), {}, "support_step: unknown field 'falling'"),
    "no width": (("support_step", "step_width"), None, "support_step.step_width = None is not a finite number"),
    "setting off at once": (("support_step", "setting_off"), 0, "support_step.setting_off = 0 must be positive"),
    "a margin of a metre": (("support_step", "pressure_margin"), 1, "pressure_margin = 1 is above 0.1 m"),
    "a fall": (("support_step", "rising", "beta_end"), -2.0, "beta_start must be below beta_end"),
    "degree 31": (("support_step", "rising", "fri_bezier"), [0.0] * 32, "support_step.rising.fri_bezier has 32"),
    "no double support": (("support_step", "orbit", "double_support"), -0.0, "orbit.double_support = -0 must be"),
    "no speed": (("support_step", "orbit", "beta_dot_after_impact"), "fast", "beta_dot_after_impact = 'fast'"),
    "another orbit": (("support_step", "orbit", "multiplier"), 0.5, "unknown field 'multiplier'"),
    "a strange double support": (("specification", "double_support"), [0.2, 0.1], "is not a range"),
    "travel": (("specification", "travel"), 0.1, "leave one of them out"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_in_one_line(written, case):
    place, value, words = REFUSED[case]
    path = written(place, value)
    with pytest.raises(GaitFileError) as caught:
        load_filed_gait(path)
    said = str(caught.value)
    assert said.startswith(str(path)) and words in said and said.isprintable() and len(said) < LONGEST_LINE


@pytest.mark.parametrize("place", [("support_step", "rising"), ("support_step", "orbit", "cost"), ("robot", "name")])
def test_a_missing_field_is_refused(written, place):
    with pytest.raises(GaitFileError, match=place[-1]):
        load_filed_gait(written(place))


def test_its_specification_says_how_long_both_feet_stand(written):
    with pytest.raises(GaitFileError, match=r"specification\.double_support is missing; write"):
        load_filed_gait(written(("specification", "double_support")))


@pytest.mark.parametrize("key", ["double_support", "setting_off", "pressure_margin"])
def test_ends_of_the_ranges_belong_to_them(written, key):
    place = ("support_step", "orbit", key) if key == "double_support" else ("support_step", key)
    open_end = key == "pressure_margin"
    for value in (GAIT[key].low, GAIT[key].high * (1.0 - 1e-9 * open_end)):
        load_filed_gait(written(place, value))


def places(content, before=()):
    parts = content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    for key, part in parts:
        yield (*before, key)
        yield from places(part, (*before, key))


@pytest.mark.filterwarnings("error")
@settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.sampled_from(list(places(CONTENT))), st.sampled_from(VALUES) | st.floats())
def test_one_value_changed(written, place, value):
    path = written(place, value)
    try:
        gait = load_filed_gait(path)
    except GaitFileError as error:
        said = str(error)
        assert said.startswith(str(path)) and said.isprintable() and len(said) < LONGEST_LINE
        return
    repr(gait)
    support_gait_to_dict(gait)
