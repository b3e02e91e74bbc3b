"""Files that version 0.1.0 wrote (data/version_0_1_0): today's code reads them, and they still mean the same.

`walker.toml` was proposed for `walker.urdf`, the robot of Table I under another name; `gait.json` designed for it,
`without_specification.json` is the same gait as a program of one's own saved it. `run.npz` walks it for two steps,
recorded at 100 Hz. `library` holds the two gaits of `sweep.toml`. `walk.scenario.toml`, a push, is collected by the
plugin beside this: it must still end as expected.
"""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from frontal_biped.analysis.closed_form import analyze
from frontal_biped.figures.time import ground_reaction, swing_foot_height
from frontal_biped.gait import GaitSpecification, check_constraints, default_specification, load_gait, save_gait
from frontal_biped.gait.file import gait_from_dict
from frontal_biped.library import GaitLibrary, build_library
from frontal_biped.library.sweep import read_sweep
from frontal_biped.model import Stance, load_robot
from frontal_biped.scenarios import load_scenario
from frontal_biped.simulation import load_trajectory, save_trajectory, simulate

OLD = Path(__file__).parent / "data" / "version_0_1_0"

RESIDUAL = 1e-9
"""What a gait may be off from being one."""

RETURN = 1e-3
"""Relative error of a post-impact speed after a step at 1 kHz; the gait's multiplier takes a quarter of it away."""


@pytest.fixture(scope="module")
def walker():
    return load_robot(OLD / "walker.toml")


@pytest.fixture(scope="module")
def old_gait():
    return load_gait(OLD / "gait.json")


@pytest.fixture(scope="module")
def run():
    return load_trajectory(OLD / "run.npz")


class TestDescription:
    def test_robot(self, walker):
        assert walker.name == "walker"
        assert walker.mass == pytest.approx(60.7)
        assert walker.sole == (-0.05, 0.05)

    def test_gait_table(self, walker):
        expected = GaitSpecification(
            8, 4, swing_clearance=0.008, step_duration=(0.3, 0.8), step_width=(0.16, 0.36), max_pelvis_roll=0.1745
        )
        assert default_specification(walker) == expected

    def test_fingerprint_is_the_one_its_gait_names(self, walker, old_gait):
        """Otherwise every old gait would be called another robot's."""
        assert old_gait.robot.fingerprint == walker.fingerprint
        assert Path(old_gait.robot.description) == OLD.resolve() / "walker.toml"


class TestGait:
    def test_specification(self, old_gait):
        assert old_gait.specification == GaitSpecification(
            friction=0.5, step_width=(0.28, 0.32), max_pelvis_roll=0.12, max_torque=(60.0, 120.0, 120.0, 60.0)
        )

    @pytest.mark.parametrize("name", ["gait.json", "without_specification.json"])
    def test_it_is_a_gait(self, walker, name):
        gait = load_gait(OLD / name)
        step = gait.step(walker)
        assert max(gait.residuals(walker, step).values()) < RESIDUAL
        assert check_constraints(walker, gait.specification, gait.rising, gait.falling, step).satisfied

    @pytest.mark.slow
    def test_certified(self, walker, old_gait):
        assert analyze(walker, old_gait).certified

    @pytest.mark.parametrize("name", ["gait.json", "without_specification.json"])
    def test_walks_a_step(self, walker, name):
        gait = load_gait(OLD / name)
        run = simulate(walker, gait, steps=1, period=1e-3, stabiliser="adaptive")
        assert run.outcome == "completed"
        assert run.post_impact_speeds[-1] == pytest.approx(gait.orbit.beta_dot_after_impact, rel=RETURN)

    def test_saved_again_it_says_the_same(self, tmp_path):
        """As version 2, whose one step holds what stood beside the others in version 1, every bit of it."""
        for name in ("gait.json", "walker.toml"):
            shutil.copy(OLD / name, tmp_path)
        save_gait(load_gait(tmp_path / "gait.json"), tmp_path / "gait.json")
        new, old = (json.loads((at / "gait.json").read_text(encoding="utf-8")) for at in (tmp_path, OLD))
        (step,) = new.pop("steps")
        assert (old.pop("version"), new.pop("version")) == (1, 2)
        assert new | step == old

    def test_without_a_specification_the_defaults_hold(self, old_gait):
        assert json.loads((OLD / "without_specification.json").read_text(encoding="utf-8"))["specification"] == {}
        bare = load_gait(OLD / "without_specification.json")
        assert bare.specification == GaitSpecification()
        assert bare.orbit == old_gait.orbit


class TestRun:
    def test_what_happened(self, run, walker, old_gait):
        assert (run.outcome, run.steps_completed, run.robot) == ("completed", 2, "walker")
        speeds = run.post_impact_speeds
        assert speeds == pytest.approx(np.full(3, old_gait.orbit.beta_dot_after_impact), rel=RETURN)
        assert run.t[-1] == pytest.approx(2.0 * old_gait.orbit.step_duration, rel=RETURN)
        assert np.all(np.abs(run.u) <= old_gait.specification.torque_limits(walker))

    def test_its_gait_is_the_one_in_the_file(self, run):
        stored = gait_from_dict(run.gait, "the run")
        again = load_gait(OLD / "gait.json")
        assert (stored.specification, stored.orbit) == (again.specification, again.orbit)

    def test_walked_again(self, run, walker, old_gait):
        """The same robot, gait and controller: the states after the impacts agree."""
        again = simulate(walker, old_gait, steps=2, period=1e-3, stabiliser="adaptive")
        assert again.post_impact_states() == pytest.approx(run.post_impact_states(), abs=1e-6)

    def test_drawn(self, run, walker):
        cone = ground_reaction(walker, run).axes[1].get_legend_handles_labels()[1]
        assert any("0.5" in label for label in cone)
        assert swing_foot_height(walker, run).axes[0].has_data()

    def test_saved_again(self, run, tmp_path):
        save_trajectory(run, tmp_path / "run.npz")
        again = load_trajectory(tmp_path / "run.npz")
        assert again.settings == run.settings
        assert np.array_equal(again.q, run.q)


class TestLibrary:
    @pytest.fixture
    def folder(self, tmp_path):
        return Path(shutil.copytree(OLD / "library", tmp_path / "library"))

    def test_taken_up_again(self, folder):
        """Nothing is designed anew, and the index is written as it was."""
        (folder / "index.csv").unlink()
        report = build_library(read_sweep(OLD / "sweep.toml"), folder)
        assert (report.points, report.gaits, report.found) == (2, 2, 2)
        assert (folder / "index.csv").read_bytes() == (OLD / "library" / "index.csv").read_bytes()

    def test_its_gaits(self, biped):
        library = GaitLibrary(OLD / "library")
        for point in library.points:
            gait = library.gait(point.number)
            assert gait.specification == point.specification
            assert max(gait.residuals(biped).values()) < RESIDUAL

    def test_blended(self, biped):
        blend = GaitLibrary(OLD / "library").blend(biped, {"max_pelvis_roll": 0.12})
        assert blend.weights == pytest.approx((0.5, 0.5))
        assert max(blend.gait.residuals(biped).values()) < RESIDUAL


def test_scenario(walker):
    scenario = load_scenario(OLD / "walk.scenario.toml")
    assert load_robot(scenario.robot).fingerprint == walker.fingerprint
    assert GaitSpecification.from_dict(scenario.gait) == GaitSpecification(
        friction=0.5,
        step_width=(0.2, 0.25),
        step_duration=(0.3, 0.4),
        min_phase_range=0.04,
        max_pelvis_roll=0.07,
        fri_margin=0.03,
    )
    assert (scenario.steps, scenario.seed, scenario.stance) == (3, 4, Stance.LEFT)
    assert (scenario.controller.kind, scenario.controller.stabiliser) == ("walker", "ankle")
    assert [(push.impulse, push.duration, push.height) for push in scenario.pushes] == [(1.0, 0.1, 0.2)]
    assert scenario.expect.torque == 1.0
