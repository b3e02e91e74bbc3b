"""Designing two steps in turn: exact derivatives, one step as a special case, the travel that was asked for."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from frontal_biped.design.optimise import optimise_gait
from frontal_biped.design.problem import DesignProblem
from frontal_biped.design.sideways import design_sideways_gait, verify_two_steps
from frontal_biped.design.sideways_studies import cost_of_travel
from frontal_biped.design.two_step_problem import TwoStepProblem
from frontal_biped.design.walking_gait import design_gait
from frontal_biped.exceptions import SpecificationError
from frontal_biped.gait.file import load_any_gait
from frontal_biped.gait.sideways import SidewaysGait
from frontal_biped.gait.specification import GaitSpecification
from frontal_biped.model.stance_map import Stance
from frontal_biped.simulation.walking import simulate, walk

DATA = Path(__file__).parents[1] / "data"

NODES = 16
DIFFERENCE = 1e-6
"""Step of the central differences, and with second derivatives of order 1e3 about their error in scaled values."""

ROUNDING = 1e-10
"""Relative; the same formulas, summed in another order."""


@pytest.fixture(scope="module")
def sideways():
    return load_any_gait(DATA / "sideways.gait.json")


class TestProblem:
    @pytest.fixture
    def problem(self, biped):
        return TwoStepProblem(biped, GaitSpecification(travel=0.1), NODES)

    @pytest.fixture
    def x(self, problem, sideways):
        return problem.joined(*(problem.step.layout.of(step) for step in sideways.steps))

    def test_equal_steps_are_one_step(self, biped, reference_gait):
        one = DesignProblem(biped, GaitSpecification(), NODES)
        two = TwoStepProblem(biped, GaitSpecification(travel=0.0), NODES)
        alone = one.variables(reference_gait)
        at, both = one.evaluate(alone), two.evaluate(two.joined(alone, alone))
        assert both.cost == pytest.approx(at.cost, rel=ROUNDING)
        assert both.equality == pytest.approx(np.full(2, at.equality[0]), abs=ROUNDING)
        assert both.margins.min() == pytest.approx(at.margins.min(), abs=ROUNDING)

    def test_derivatives(self, problem, x):
        point = problem.evaluate(x)
        for i in range(0, problem.size, 5):
            shift = np.zeros(problem.size)
            shift[i] = DIFFERENCE
            above, below = problem.evaluate(x + shift), problem.evaluate(x - shift)
            for name in ("cost", "equality", "margins"):
                slope = (getattr(above, name) - getattr(below, name)) / (2.0 * DIFFERENCE)
                exact = point.cost_gradient[i] if name == "cost" else getattr(point, f"{name}_jacobian")[:, i]
                scale = 1.0 + np.max(np.abs(exact))
                assert np.max(np.abs(slope - exact)) < 1e-4 * scale, (name, i)

    def test_variables_are_what_was_joined(self, problem, x, sideways):
        a, b = problem.split(x)
        assert a == pytest.approx(problem.step.layout.of(sideways.a), abs=1e-12)
        assert b == pytest.approx(problem.step.layout.of(sideways.b), abs=1e-12)
        assert problem.widths(x) == pytest.approx((0.35, 0.25), abs=1e-9)

    def test_phases_are_those_of_the_gait(self, problem, x, sideways):
        for own, step in zip(problem.phases(x), sideways.steps, strict=True):
            for phase, stored in zip(own, step.phases, strict=True):
                assert phase.joint_bezier == pytest.approx(stored.joint_bezier, abs=1e-9)

    def test_carried_over_there_and_back(self, problem, x):
        nearer = TwoStepProblem(problem.biped, replace(problem.specification, travel=0.06), NODES)
        there = nearer.carried(x, 0.1)
        assert nearer.widths(there)[0] - nearer.widths(there)[1] == pytest.approx(0.06)
        assert np.isfinite(nearer.evaluate(there).cost)

    def test_start_has_a_value(self, problem):
        assert np.isfinite(problem.evaluate(problem.start()).cost)


class TestDesign:
    @pytest.fixture(scope="class")
    @classmethod
    def result(cls, biped, reference_gait):
        specification = replace(reference_gait.specification, travel=0.04)
        return design_sideways_gait(biped, specification, quick=True, start=reference_gait)

    def test_travels_as_far_as_asked(self, result):
        assert isinstance(result.gait, SidewaysGait), result.message
        assert result.gait.travel == pytest.approx(0.04, abs=1e-12)
        assert result.verification.passed
        assert result.gait.provenance["walk"] == "left out (quick)"

    @pytest.mark.slow
    def test_no_farther_than_another_start_finds(self, biped, result, sideways):
        """From a gait of more travel the same minimum is found."""
        again = design_sideways_gait(biped, result.gait.specification, quick=True, start=sideways)
        assert again.gait is not None, again.message
        assert again.gait.cost == pytest.approx(result.gait.cost, rel=1e-6)

    @pytest.mark.slow
    def test_costs_grow_with_the_travel(self, biped):
        points = cost_of_travel(biped, GaitSpecification(), (0.02, 0.04, 0.06))
        costs = [point.gait.cost for point in points]
        assert costs == sorted(costs)

    def test_what_travel_does_not_go_with(self, biped, sideways):
        spec = GaitSpecification(travel=0.1)
        with pytest.raises(SpecificationError, match=r"travel = 0\.1 m: a gait of equal steps"):
            optimise_gait(biped, spec)
        with pytest.raises(SpecificationError, match="travel is not given"):
            design_sideways_gait(biped, GaitSpecification())
        with pytest.raises(SpecificationError, match=r"travel.*leave out attempts"):
            design_gait(biped, spec, attempts=3)
        with pytest.raises(SpecificationError, match="start: two steps in turn"):
            design_gait(biped, start=sideways)


class TestWalk:
    def test_two_simulated_steps_return(self, biped, sideways):
        assert verify_two_steps(biped, sideways).passed

    @pytest.mark.parametrize("stance", Stance)
    def test_travels_away_from_the_first_foot(self, biped, sideways, stance):
        run = simulate(biped, sideways, steps=4, period=None, stance=stance)
        assert run.outcome == "completed"
        places = run.stance_y[run.stance == stance.sign]
        assert places[-1] - places[0] == pytest.approx(-stance.sign * sideways.travel, abs=1e-6)
        assert run.t[-1] == pytest.approx(2.0 * sideways.duration, rel=1e-6)

    def test_ours_from_sensor_readings(self, biped, sideways):
        run = walk(biped, sideways, engine="ours", steps=6)
        assert run.outcome == "completed"
        places = run.stance_y[run.stance > 0.0]
        assert places[-1] - places[0] == pytest.approx(-2.0 * sideways.travel, rel=0.05)

    @pytest.mark.slow
    @pytest.mark.parametrize("engine", ["ours", "mujoco"])
    def test_fifty_steps(self, biped, sideways, engine):
        if engine == "mujoco":
            pytest.importorskip("mujoco")
        run = walk(biped, sideways, engine=engine, steps=50)
        assert (run.outcome, run.steps_completed) == ("completed", 50)
