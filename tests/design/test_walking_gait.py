"""A gait is called one when it walks: what governs a fall is tightened, within a budget, and all of it is said."""

from dataclasses import replace

import pytest

from frontal_biped.design import walking_gait
from frontal_biped.design.tightening import tightenings
from frontal_biped.design.walk_trial import EngineWalk, WalkTrial, engines, try_walk
from frontal_biped.design.walking_gait import design_gait
from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait import GaitSpecification, load_specification
from frontal_biped.gait.file import load_gait, save_gait
from frontal_biped.simulation.falls import GOVERNING, OFF_SPEED
from frontal_biped.simulation.hybrid_system import EventKind

GOOD = WalkTrial((EngineWalk("ours", 20, "completed", 0.5, 0.01, 1.1),))


def fallen(event, engine="ours"):
    return WalkTrial((EngineWalk(engine, 3, event, 0.5, 0.01, 1.1),))


@pytest.fixture
def walks(monkeypatch):
    """Answers in place of walks, in order, the last one for all further gaits; and the gaits that were walked."""
    seen, answers = [], [GOOD]

    def answer(biped, gait, steps, on_step):
        seen.append(gait)
        return answers.pop(0) if len(answers) > 1 else answers[0]

    monkeypatch.setattr(walking_gait, "try_walk", answer)
    return answers, seen


@pytest.mark.parametrize("event", [*GOVERNING, "something new"])
def test_every_stage_asks_for_more_than_before(event):
    spec = GaitSpecification()
    stages = list(tightenings(spec, event))
    keys = {"max_foot_rotation", "swing_clearance", "fri_margin", "step_duration"}
    slipped = event == EventKind.SLIPPED.value
    assert {change.key for change in stages} == keys | ({"friction"} if slipped else set())
    for change in stages:
        tighter = change.of(spec)
        assert tighter != spec
        assert change.old == getattr(spec, change.key)
        if change.key == "step_duration":
            assert spec.step_duration[0] < change.new[0] <= change.new[1] == spec.step_duration[1]
        else:
            assert (change.new < (change.old or 1.0)) == (change.key in {"max_foot_rotation", "friction"})


def test_a_level_foot_comes_first_where_it_landed_on_its_edge():
    first = next(tightenings(GaitSpecification(), EventKind.EDGE_LANDING.value))
    assert (first.key, first.new) == ("max_foot_rotation", 0.05)
    level = next(tightenings(GaitSpecification(max_foot_rotation=0.02), EventKind.EDGE_LANDING.value))
    assert level.key != "max_foot_rotation"


def test_a_gait_that_walks_is_the_certified_one_and_says_so(biped, reference_gait, walks, tmp_path):
    result = design_gait(biped, GaitSpecification())
    assert result.success
    assert result.tightened == ()
    assert result.gait.rising.joint_bezier.tolist() == reference_gait.rising.joint_bezier.tolist()
    save_gait(result.gait, tmp_path / "g.json")
    record = load_gait(tmp_path / "g.json").provenance["walk"]
    assert record["engines"]["ours"]["steps"] == 20
    assert record["cost_given_away"] == 0.0
    assert result.walk is GOOD


@pytest.mark.slow
def test_what_governs_the_fall_is_tightened(biped, walks):
    answers, seen = walks
    answers[:] = [fallen(EventKind.EDGE_LANDING.value, "mujoco"), GOOD]
    lines = []
    result = design_gait(biped, GaitSpecification(), tell=lines.append)
    assert result.success
    (change,) = result.tightened
    assert (change.key, change.engine) == ("max_foot_rotation", "mujoco")
    assert result.gait.specification.max_foot_rotation == change.new
    given_away = result.gait.orbit.cost / seen[0].orbit.cost - 1.0
    assert 0.0 < given_away < walking_gait.BUDGET
    assert result.gait.provenance["walk"]["cost_given_away"] == pytest.approx(given_away)
    assert "max_foot_rotation = 0.05" in result.message
    assert "fell after 3 steps" in lines[0]


@pytest.mark.slow
def test_the_budget_is_kept(biped, walks):
    """A level foot costs 2.6 % here: with less to give away the reason is said, and no gait is handed over."""
    answers, _ = walks
    answers[:] = [fallen(EventKind.EDGE_LANDING.value)]
    result = design_gait(biped, GaitSpecification(), budget=1e-4)
    assert result.gait is None
    assert not result.success
    assert "does not walk" in result.message
    assert EventKind.EDGE_LANDING.value in result.message
    with pytest.raises(SpecificationError, match="budget = -1"):
        design_gait(biped, budget=-1.0)


@pytest.mark.slow
def test_changes_add_up_where_another_event_ends_the_next_walk(biped, walks, monkeypatch):
    answers, _ = walks
    answers[:] = [fallen(EventKind.EDGE_LANDING.value), fallen(EventKind.EARLY_LANDING.value), GOOD]
    result = design_gait(biped, GaitSpecification())
    assert [change.key for change in result.tightened] == ["max_foot_rotation", "swing_clearance"]
    spec = result.gait.specification
    assert (spec.max_foot_rotation, spec.swing_clearance) == tuple(change.new for change in result.tightened)


@pytest.mark.slow
def test_one_stage_after_another_where_the_same_event_goes_on(biped, walks, monkeypatch):
    """A stage that does not help is taken back."""
    answers, seen = walks
    answers[:] = [fallen("something new")] * 4
    monkeypatch.setattr(walking_gait, "MOST_DESIGNS", 3)
    assert design_gait(biped, GaitSpecification()).gait is None
    asked = [(gait.specification.max_foot_rotation, gait.specification.swing_clearance) for gait in seen]
    assert asked == [(None, 0.01), (0.05, 0.01), (0.02, 0.01), (None, 0.015)]


def test_walking_at_another_speed_is_no_walk():
    assert OFF_SPEED in GOVERNING
    off = replace(GOOD.walks[0], outcome=OFF_SPEED, speed_error=0.3)
    assert not off.walked
    assert str(off).endswith("speed half-way down +30.0 %, J 1.10 times the gait's")


@pytest.mark.slow
def test_rough_walks_in_every_engine(biped):
    gait = walking_gait.optimise_gait(biped, load_specification("rough")).gait
    trial = try_walk(biped, gait)
    assert trial.walked
    assert tuple(walk.engine for walk in trial.walks) == engines()
    for walk in trial.walks:
        assert walk.steps == 20
        assert abs(walk.speed_error) < 0.02
        assert walk.step_time == pytest.approx(gait.orbit.step_duration, rel=0.01)
        assert walk.cost_ratio == pytest.approx(1.0, abs=0.05)
