"""Gaits of two steps: their files, numbers, residuals and verdict."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from frontal_biped.exceptions import GaitFileError, SpecificationError
from frontal_biped.gait.file import load_any_gait, load_gait, save_gait
from frontal_biped.gait.given import any_gait_of, gait_of
from frontal_biped.gait.sideways import SidewaysGait
from frontal_biped.gait.sideways_verdict import judge_sideways
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.numerics.verdict import Verdict

FILE = Path(__file__).parents[1] / "data" / "sideways.gait.json"

RESIDUAL = 1e-9
"""What a gait may be off from being one."""


@pytest.fixture(scope="module")
def sideways():
    return load_any_gait(FILE)


class TestFile:
    def test_saved_again_byte_for_byte(self, sideways, tmp_path):
        save_gait(sideways, tmp_path / "gait.json")
        assert (tmp_path / "gait.json").read_bytes() == FILE.read_bytes()

    def test_refused_where_one_step_is_needed(self, sideways):
        for refused in (lambda: load_gait(FILE), lambda: gait_of(sideways), lambda: gait_of(FILE)):
            with pytest.raises(GaitFileError, match=r"two steps.*on the spot.*without travel"):
                refused()

    def test_given_in_every_way(self, sideways):
        for given in (sideways, FILE, str(FILE)):
            assert isinstance(any_gait_of(given), SidewaysGait)

    def test_the_wide_step_comes_first(self, tmp_path):
        content = json.loads(FILE.read_text(encoding="utf-8"))
        content["steps"].reverse()
        (tmp_path / "gait.json").write_text(json.dumps(content), encoding="utf-8")
        with pytest.raises(GaitFileError, match=r"steps\[0\]\.step_width = 0\.25 is below .*exchange them"):
            load_any_gait(tmp_path / "gait.json")

    def test_a_complaint_names_the_step(self, tmp_path):
        content = json.loads(FILE.read_text(encoding="utf-8"))
        content["steps"][1]["orbit"]["cost"] = "dear"
        (tmp_path / "gait.json").write_text(json.dumps(content), encoding="utf-8")
        with pytest.raises(GaitFileError, match=r"steps\[1\]\.orbit\.cost = 'dear'"):
            load_any_gait(tmp_path / "gait.json")


class TestNumbers:
    def test_travel_and_speed(self, sideways):
        assert sideways.travel == pytest.approx(0.1, abs=1e-12)
        assert sideways.speed == pytest.approx(0.1 / sideways.duration)
        assert "0.100 m in two steps" in repr(sideways)

    def test_cost_of_travel(self, sideways):
        effort = sum(step.orbit.cost * step.step_width for step in sideways.steps)
        assert sideways.cost_of_travel == pytest.approx(effort / 0.1, rel=1e-9)
        on_the_spot = replace(sideways, a=replace(sideways.a, step_width=sideways.b.step_width))
        assert on_the_spot.cost_of_travel == np.inf

    def test_orbit_against_a_new_integration(self, biped, sideways):
        residuals = sideways.residuals(biped)
        assert max(residuals.values()) < RESIDUAL, residuals

    def test_a_moved_coefficient_of_one_step_shows_in_the_other(self, biped, sideways):
        """The final slope of B is what A begins with."""
        moved = sideways.b.falling.joint_bezier.copy()
        moved[1, -2] += 1e-4
        falling = replace(sideways.b.falling, joint_bezier=moved)
        residuals = replace(sideways, b=replace(sideways.b, falling=falling)).residuals(biped)
        assert residuals["B: impact_slope"] > RESIDUAL
        assert residuals["A: impact_slope"] < RESIDUAL
        assert residuals["stored_orbit"] > RESIDUAL


class TestVerdict:
    def test_certified(self, biped, sideways):
        judged = judge_sideways(biped, sideways)
        assert judged.verdict is Verdict.CERTIFIED, judged.objections
        assert judged.reversal.is_reversal

    def test_another_bound_is_seen_in_the_step_that_misses_it(self, biped, sideways):
        tight = replace(sideways.specification, step_width=(0.15, 0.3), travel=None)
        judged = judge_sideways(biped, sideways, tight)
        assert judged.verdict is Verdict.REFUTED
        assert [objection.reason for objection in judged.objections if "step width" in objection.reason] != []
        assert all("B: step width" not in objection.reason for objection in judged.objections)

    def test_the_bound_of_the_multiplier_is_one_a_step(self, biped, sideways):
        mean = float(np.sqrt(sideways.multiplier))
        for bound, verdict in ((mean + 1e-3, Verdict.CERTIFIED), (mean - 1e-3, Verdict.REFUTED)):
            asked = replace(sideways.specification, max_multiplier=bound)
            assert judge_sideways(biped, sideways, asked).verdict is verdict

    @pytest.mark.slow
    def test_another_energy_is_refuted(self, biped, sideways):
        moved = sideways.a.rising.joint_bezier.copy()
        moved[0, 3] += 1e-3
        rising = replace(sideways.a.rising, joint_bezier=moved)
        assert judge_sideways(biped, replace(sideways, a=replace(sideways.a, rising=rising))).verdict is Verdict.REFUTED


class TestSpecification:
    def test_travel_needs_room_between_the_widths(self):
        assert GaitSpecification(travel=0.2).travel == 0.2
        for travel in (-0.01, 0.21):
            with pytest.raises(SpecificationError, match=r"travel = .* m in two steps is not in \[0, 0.2\]"):
                GaitSpecification(travel=travel)
