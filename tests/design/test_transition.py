"""One step from a gait to another: on the zero dynamics at both switches, in closed form and in the full model."""

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.control.controller import QpController
from frontal_biped.control.sequence import GaitSequence
from frontal_biped.design import design_transition, optimise_gait
from frontal_biped.design.ends import Between
from frontal_biped.design.problem import DesignProblem
from frontal_biped.exceptions import DesignFailedError, GaitFileError
from frontal_biped.gait import GaitSpecification
from frontal_biped.model import impact
from frontal_biped.simulation.event_driven import simulate_walk
from frontal_biped.simulation.settings import SimulationSettings
from frontal_biped.zero_dynamics.poincare import step_orbit

JOINED = 1e-9
"""Pose, slope and relative speed at a switch."""

INVARIANT = 1e-6
"""Output error of the full model on the way [rad]: the integrator's tolerance of 1e-9, amplified by a step or two."""

GRADIENT_TOLERANCE = 1e-6


@pytest.fixture(scope="module")
def narrow(biped):
    return optimise_gait(biped, GaitSpecification(step_width=(0.28, 0.28), max_pelvis_roll=0.15)).gait


@pytest.fixture(scope="module")
def wide(biped):
    return optimise_gait(biped, GaitSpecification(step_width=(0.32, 0.32), max_pelvis_roll=0.12)).gait


@pytest.fixture(scope="module", params=["widening", "narrowing"])
def ends(request, narrow, wide):
    return (narrow, wide) if request.param == "widening" else (wide, narrow)


@pytest.fixture(scope="module")
def transition(biped, ends):
    return design_transition(biped, *ends)


def test_it_begins_where_the_first_gait_lands(transition, ends):
    begin = transition.rising.motion(np.array([transition.rising.beta_start]))
    q_first, dq_first = ends[0].state_after_impact()
    assert_close(begin.q[0], q_first, JOINED)
    assert_close(begin.dq[0] * transition.speed_after_impact, dq_first, JOINED)


def test_it_lands_where_the_second_gait_lands(biped, transition, ends):
    states = []
    for walked in (transition, ends[1]):
        step = step_orbit(biped, walked.rising, walked.falling, walked.step_width, 40)
        q = step.falling.motion.q[-1]
        states.append(impact(biped, q, step.falling.motion.dq[-1] * step.falling.dbeta[-1]))
    assert_close(states[0].q_plus, states[1].q_plus, JOINED)
    assert_close(states[0].dq_plus, states[1].dq_plus, 10.0 * JOINED)
    assert abs(transition.speed_error) < JOINED


def test_its_numbers_are_those_of_the_step(biped, transition, ends):
    """On other quadrature nodes; it lands as wide as the second gait."""
    step = step_orbit(biped, transition.rising, transition.falling, transition.step_width, 60)
    assert transition.step_width == ends[1].step_width
    assert transition.duration == pytest.approx(float(step.duration), rel=JOINED)
    assert transition.cost == pytest.approx(float(step.cost), rel=JOINED)
    assert transition.speed_after_impact == pytest.approx(float(step.rising.dbeta[-1]), rel=JOINED)
    assert transition.speed_before_impact == pytest.approx(float(step.falling.dbeta[-1]), rel=JOINED)


def test_every_constraint_holds(transition):
    assert transition.report.satisfied, str(transition.report)
    assert not any("multiplier" in check.name for check in transition.report.checks)


def test_full_model_walks_from_one_to_the_other(biped, transition, ends):
    before, after = ends
    parts = [(before, 1), (transition, 1), (after, 2)]
    sequence = GaitSequence([(QpController(biped, gait), steps) for gait, steps in parts])
    run = simulate_walk(biped, sequence, before.state_after_impact(), SimulationSettings(steps=3))
    assert not run.fell
    assert np.max(np.abs(run.output_error)) < INVARIANT
    assert_close(run.post_impact_states()[-1], np.concatenate(after.state_after_impact()), INVARIANT)


def test_derivatives_against_differences(biped, narrow, wide):
    problem = DesignProblem(biped, GaitSpecification(), 16, ends=Between(biped, narrow, wide))
    low, high = problem.bounds()
    free = np.flatnonzero(high > low)
    assert problem.size - len(free) == 5  # beta_f-, the step width and one column
    x, step = problem.start(), 1e-7
    exact = problem.evaluate(x)
    for i in free[::3]:
        shift = step * np.eye(problem.size)[i]
        above, below = problem.evaluate(x + shift), problem.evaluate(x - shift)
        for part in ("equality", "margins"):
            difference = (getattr(above, part) - getattr(below, part)) / (2.0 * step)
            derivative = getattr(exact, f"{part}_jacobian")[:, i]
            error = np.abs(difference - derivative) / np.maximum(1.0, np.abs(getattr(exact, f"{part}_jacobian")).max(1))
            assert np.max(error) < GRADIENT_TOLERANCE, (part, i)


def test_every_free_variable_moves_the_step(biped, narrow, wide):
    """Held is what the second gait's landing fixes, and nothing that the step could use."""
    problem = DesignProblem(biped, GaitSpecification(), 16, ends=Between(biped, narrow, wide))
    low, high = problem.bounds()
    point = problem.evaluate(problem.start())
    effect = np.max(np.abs(np.vstack([point.equality_jacobian, point.margins_jacobian])), axis=0)
    assert np.all(effect[high > low] > 1e-3)


def test_a_gait_is_a_transition_to_itself(biped, narrow):
    """The periodic gait solves its own transition problem: both equalities vanish at its variables."""
    problem = DesignProblem(biped, narrow.specification, 40, ends=Between(biped, narrow, narrow))
    x = problem.variables(narrow)
    assert_close(problem.evaluate(x).equality, np.zeros(2), JOINED, floor=1.0)


def test_gaits_of_different_robots_are_refused(biped, narrow, wide):
    from dataclasses import replace

    stranger = replace(wide, robot=replace(wide.robot, name="stranger", fingerprint="0" * 64))
    with pytest.raises(GaitFileError, match="stranger"):
        design_transition(biped, narrow, stranger)


def test_an_impossible_step_is_refused(biped, narrow, wide):
    with pytest.raises(DesignFailedError, match="no single step"):
        design_transition(biped, narrow, wide, GaitSpecification(swing_clearance=0.3))
