"""The studio without its screen: what runs next, what stays, what is told."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from frontal_biped.gait import GaitSpecification, default_specification
from frontal_biped.gait.file import load_gait
from frontal_biped.model import load_robot
from frontal_biped.studio import jobs, status
from frontal_biped.studio.knobs import knobs_for
from frontal_biped.studio.workbench import Workbench


class Recorder:
    """A worker that runs nothing until told to."""

    def __init__(self, listener, name):
        self.listener, self.name = listener, name
        self.requests = []
        self.closed = False

    def submit(self, job, *arguments):
        self.requests.append((job, arguments))
        return len(self.requests)

    def close(self):
        self.closed = True

    def answer(self, content, kind="done", number=None):
        self.listener(len(self.requests) if number is None else number, kind, content)

    @property
    def last(self):
        return self.requests[-1]


@pytest.fixture
def studio(tmp_path):
    workers = {}

    def make(listener, name):
        workers[name] = Recorder(listener, name)
        return workers[name]

    workbench = Workbench("frontal_biped", tmp_path, make)
    workbench.begin()
    return workbench, workers["studio-designer"], workers["studio-helper"]


@pytest.fixture(scope="session")
def designed(reference_gait, reference_design):
    return jobs.Designed(reference_gait, reference_design.report, reference_design.message, 0.1, None)


REFUSED = jobs.Designed(None, None, "no gait was found; relax friction", 0.2, None)
CERTIFIED = jobs.Certified(True, "yes", 1e-12, ())
PROVED = (("0 < multiplier < 1", "certified", "proved"),)


def opened(studio, designed):
    workbench, designer, helper = studio
    helper.answer("a drawing")
    designer.answer(designed)
    return workbench, designer, helper


def test_opening_draws_designs_and_certifies(studio, designed):
    workbench, designer, helper = studio
    assert designer.last[0] is jobs.opening and helper.last[0] is jobs.draw
    designer.answer(designed)
    assert workbench.state.gait is designed.gait and workbench.state.fits
    assert len(helper.requests) == 1  # the drawing is not interrupted
    helper.answer("a drawing")
    assert workbench.state.drawing == "a drawing"
    assert helper.last == (jobs.certify, ("frontal_biped", designed.gait))
    helper.answer(CERTIFIED)
    assert workbench.state.certificate is CERTIFIED
    assert helper.last == (jobs.prove, ("frontal_biped", designed.gait))
    helper.answer(PROVED)
    assert workbench.state.proof is PROVED
    shown = status.headline(workbench.state)
    assert "0 &lt; multiplier &lt; 1" in shown and "<b>proved</b>" in shown


def test_newest_slider_wins_and_starts_from_the_present_gait(studio, designed):
    workbench, designer, _ = opened(studio, designed)
    for degrees in (15.0, 12.0, 9.0):
        workbench.turn("max_pelvis_roll", degrees)
    job, (robot, specification, start) = designer.last
    assert job is jobs.design and robot == "frontal_biped" and start is designed.gait
    assert specification.max_pelvis_roll == pytest.approx(np.radians(9.0), abs=1e-9)
    stale = dataclasses.replace(designed, message="stale")
    designer.answer(stale, number=len(designer.requests) - 1)
    assert not workbench.state.fits and workbench.state.designing
    designer.answer(designed)
    assert workbench.state.fits and workbench.state.designs == 2
    assert workbench.state.previous_cost == designed.gait.orbit.cost


def test_no_design_for_a_slider_that_stands_where_it_stood(studio, designed):
    workbench, designer, _ = opened(studio, designed)
    count = len(designer.requests)
    workbench.turn("friction", 0.6)
    assert len(designer.requests) == count


def test_impossible_specification_keeps_the_last_gait(studio, designed):
    workbench, designer, _ = opened(studio, designed)
    workbench.turn("friction", 0.1)
    designer.answer(REFUSED)
    assert workbench.state.gait is designed.gait and not workbench.state.fits
    assert workbench.state.explanation == REFUSED.message
    workbench.turn("friction", 0.6)
    designer.answer(designed)
    assert workbench.state.explanation == "" and workbench.state.fits


def test_refused_value_is_explained_and_nothing_runs(studio, designed):
    workbench, designer, _ = opened(studio, designed)
    count = len(designer.requests)
    workbench.turn("friction", 0.0)
    assert "friction = 0 must be positive" in workbench.state.explanation
    assert len(designer.requests) == count


def test_push_goes_before_the_certificate_which_is_made_up_for(studio, designed):
    workbench, _, helper = opened(studio, designed)
    assert helper.last[0] is jobs.certify
    workbench.push(10.0, "at the reversal")
    assert helper.last == (jobs.push, ("frontal_biped", designed.gait, 10.0, "at the reversal"))
    helper.answer(jobs.Pushed(True, "push: recovered", None))
    assert workbench.state.push_recovered
    assert helper.last[0] is jobs.certify


def test_a_proof_waits_for_everything_else_and_is_of_the_gait_on_screen(studio, designed):
    workbench, designer, helper = opened(studio, designed)
    helper.answer(CERTIFIED)
    assert helper.last[0] is jobs.prove
    workbench.push(10.0, "at the reversal")
    assert helper.last[0] is jobs.push
    helper.answer(jobs.Pushed(True, "push: recovered", None))
    assert helper.last[0] is jobs.prove
    number = len(helper.requests)
    workbench.turn("friction", 0.5)
    designer.answer(designed)
    helper.answer(PROVED, number=number)
    assert workbench.state.proof == ()
    assert helper.last[0] is jobs.certify


def test_without_the_extra_nothing_is_proved(studio, designed, monkeypatch):
    monkeypatch.setattr(jobs, "PROVABLE", False)
    workbench, _, helper = opened(studio, designed)
    helper.answer(CERTIFIED)
    assert helper.last[0] is jobs.certify
    assert workbench.state.busy == ""


@pytest.mark.slow
def test_rows_of_a_proof(designed):
    rows = jobs.prove(lambda news: None, "frontal_biped", designed.gait)
    assert ("0 < multiplier < 1", "certified", "proved") in rows
    assert not any("CONTRADICTION" in proved for _, _, proved in rows)


def test_outcome_of_a_push_on_an_older_gait_is_dropped(studio, designed):
    workbench, designer, helper = opened(studio, designed)
    workbench.push(10.0, "at the reversal")
    number = len(helper.requests)
    workbench.turn("friction", 0.5)
    designer.answer(designed)
    helper.answer(jobs.Pushed(True, "push: recovered", None), number=number)
    assert workbench.state.push == ""
    assert helper.last[0] is jobs.certify


def test_save_writes_gait_and_page_and_overwrites_nothing(studio, designed, tmp_path):
    workbench, _, helper = opened(studio, designed)
    for number in (1, 2):
        workbench.save()
        assert helper.last[0] is jobs.page
        helper.answer("<html>page</html>")
        assert f"frontal_biped-{number}.html" in workbench.state.notice
        assert load_gait(tmp_path / f"frontal_biped-{number}.gait.json").orbit == designed.gait.orbit
        assert (tmp_path / f"frontal_biped-{number}.html").read_text() == "<html>page</html>"


def test_another_robot_brings_its_own_specification(studio, designed):
    workbench, designer, helper = opened(studio, designed)
    number = len(designer.requests)
    workbench.turn("friction", 0.5)
    workbench.choose_robot("talos_full")
    assert workbench.state.gait is None and workbench.state.robot == "talos_full"
    assert workbench.state.specification == default_specification(load_robot("talos_full"))
    designer.answer(designed, number=number + 1)  # of the robot before
    assert workbench.state.gait is None
    assert designer.last[0] is jobs.opening and helper.last[0] is jobs.draw
    workbench.choose_robot("no_such_robot")
    assert workbench.state.robot == "talos_full" and "no robot 'no_such_robot'" in workbench.state.notice


def test_nothing_to_push_or_save_before_the_first_gait(studio):
    workbench, _, helper = studio
    workbench.push(10.0, "at the reversal")
    assert "no gait" in workbench.state.notice
    workbench.save()
    assert "no gait" in workbench.state.notice and len(helper.requests) == 1


@pytest.mark.parametrize(
    "name", ["/etc/passwd", "robot.toml", "../models/frontal_biped.toml", "x" * 9000, "", "icub\0"]
)
def test_a_robot_is_one_of_the_list_and_never_a_path(studio, designed, tmp_path, monkeypatch, name):
    workbench, designer, _ = opened(studio, designed)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.toml").write_text("secret = 'told'")
    before, count = workbench.state, len(designer.requests)
    workbench.choose_robot(name)
    notice = workbench.state.notice
    assert dataclasses.replace(workbench.state, notice=before.notice) == before and len(designer.requests) == count
    assert notice == f"no robot {name[:40]!r} is offered here; choose one of the list"


def test_the_robot_of_the_command_line_is_offered_with_the_packaged_ones(studio):
    assert studio[0].robots[0] == "frontal_biped" and "icub" in studio[0].robots
    assert len(set(studio[0].robots)) == len(studio[0].robots)


@pytest.mark.parametrize(
    ("key", "value"),
    [("friction", 1e308), ("friction", float("nan")), ("friction", float("inf")), ("friction", 1.5), ("friction", -1.0),
     ("friction", (0.1, 0.2)), ("step_duration", 0.5), ("step_duration", (0.1, 0.5)), ("step_duration", (0.5, 99.0)),
     ("step_duration", (0.6, 0.3)), ("step_duration", (float("nan"), 0.5)), ("max_pelvis_roll", 90.0),
     ("swing_clearance", 1e9)],
)  # fmt: skip
def test_a_slider_stands_between_its_ends(studio, designed, key, value):
    workbench, designer, _ = opened(studio, designed)
    before, count = workbench.state.specification, len(designer.requests)
    assert not workbench.turn(key, value)
    assert workbench.state.specification == before and len(designer.requests) == count
    assert workbench.state.explanation and "\n" not in workbench.state.explanation


def test_a_slider_of_the_robot_before_does_nothing(studio, designed):
    workbench, designer, _ = opened(studio, designed)
    count = len(designer.requests)
    assert workbench.turn("no_such_key", 1.0)
    assert len(designer.requests) == count


@pytest.mark.parametrize(
    ("impulse", "moment"),
    [(40.1, "at the reversal"), (-1e308, "at the reversal"), (float("nan"), "at the reversal"),
     (float("inf"), "at the reversal"), (10.0, "never"), (10.0, "x" * 9000)],
)  # fmt: skip
def test_a_push_is_one_that_is_offered(studio, designed, impulse, moment):
    workbench, _, helper = opened(studio, designed)
    count = len(helper.requests)
    workbench.push(impulse, moment)
    assert len(helper.requests) == count and workbench.state.notice.startswith("no push of ")


def test_save_takes_no_name_that_is_there_not_even_as_a_link(studio, designed, tmp_path):
    workbench, _, helper = opened(studio, designed)
    (tmp_path / "frontal_biped-1.gait.json").symlink_to(tmp_path / "elsewhere.json")
    (tmp_path / "frontal_biped-2.html").symlink_to(tmp_path / "elsewhere.html")
    (tmp_path / "frontal_biped-3.gait.json").write_text("mine")
    workbench.save()
    (tmp_path / "frontal_biped-4.html").write_text("mine, written meanwhile")
    helper.answer("<html>page</html>")
    assert "File exists; the gait is saved, the page is not" in workbench.state.notice
    assert load_gait(tmp_path / "frontal_biped-4.gait.json").orbit == designed.gait.orbit
    assert (tmp_path / "frontal_biped-3.gait.json").read_text() == "mine"
    assert (tmp_path / "frontal_biped-4.html").read_text() == "mine, written meanwhile"
    assert not (tmp_path / "elsewhere.json").exists() and not (tmp_path / "elsewhere.html").exists()


def test_what_cannot_be_saved_leaves_nothing(studio, designed, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    workbench, _, _ = opened(studio, designed)
    monkeypatch.setattr("frontal_biped.studio.workbench.save_gait", full)
    workbench.save()
    assert "No space left on device; start the studio with -o" in workbench.state.notice
    assert list(tmp_path.iterdir()) == []


def test_closing_ends_both_workers(studio):
    workbench, designer, helper = studio
    workbench.close()
    assert designer.closed and helper.closed


@given(
    robot=st.sampled_from(("frontal_biped", "talos_full", "icub")), share=st.floats(0.0, 1.0), index=st.integers(0, 7)
)
def test_slider_and_specification_agree(robot, share, index):
    biped = load_robot(robot)
    specification = default_specification(biped)
    knob = knobs_for(biped)[index]
    value = round(knob.low + knob.step * round(share * (knob.high - knob.low) / knob.step), 9)
    value = max(value, knob.step) if knob.key == "friction" else value
    shown = knob.shown(specification)
    wanted = (min(value, shown[1]), shown[1]) if isinstance(shown, tuple) else value
    changed = knob.applied(specification, wanted)
    assert knob.shown(changed) == pytest.approx(wanted, abs=1e-9)
    others = {key: entry for key, entry in changed.as_dict().items() if key != knob.key}
    assert others == {key: entry for key, entry in specification.as_dict().items() if key != knob.key}
    assert GaitSpecification.from_dict(changed.as_dict()) == changed
