"""The quadratic program of a tick: equal to its closed form, optimal under active limits, and never silently wrong."""

import logging

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import assert_close, vectors
from scipy.optimize import linprog, nnls

from frontal_biped.control import ControllerSettings, QpController, Source
from frontal_biped.control.torques.walking_qp import DDQ, DELTA, FORCE, VARIABLES, U
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import UNBOUNDED
from frontal_biped.virtual_constraints import StepPhase

CLOSED_FORM = 1e-8
"""Relative agreement of ProxQP's answer with the closed form."""

FEASIBLE = 1e-7
"""Violation up to which a point counts as feasible, in units of the program; ProxQP is asked for 1e-9."""

STATIONARY = 1e-6
"""Gradient left over by the best multipliers of the active rows, relative to the cost's."""

NEARLY = 1e-6
"""Least violation, in units of the program, above which a linear program calls it infeasible."""

SHIPPED = ("frontal_biped", "g1", "icub", "talos_full")


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
@pytest.mark.parametrize("name", SHIPPED)
@given(
    which=st.sampled_from(list(StepPhase)),
    s=st.floats(0.0, 1.0),
    speed=st.floats(-1.0, 1.0),
    y=vectors(-0.002, 0.002, 3),
    dy=vectors(-0.02, 0.02, 3),
)
def test_proxqp_finds_the_closed_form(solvers, name, outputs, which, s, speed, y, dy):
    """Near the gait, where no limit is active, the closed form is ProxQP's answer."""
    exact, always = solvers(name, ControllerSettings(outputs=outputs))
    phase = exact.phase(which)
    beta = phase.beta_start + s * phase.range
    h_d, h_d1, *_ = phase.desired(beta)
    rate = speed * exact.gait.orbit.beta_dot_after_impact
    q, dq = np.r_[beta, h_d + y], np.r_[rate, h_d1 * rate + dy]
    known = exact.command(which, q, dq)
    assume(known.source is Source.CLOSED_FORM)
    found = always.command(which, q, dq)
    assert found.source is Source.PROGRAM
    lever = 0.1 * exact.biped.weight
    assert_close(found.u, known.u, CLOSED_FORM, floor=lever)
    assert_close(found.force, known.force, CLOSED_FORM)
    assert found.relaxation == pytest.approx(known.relaxation, abs=1e-6)


# ---------------------------------------------------------------------- independent judges
def posed(controller, which, q, dq, command):
    """The program at a state, whoever solved it, and its variables at a command."""
    state = State(q, dq)
    program, delta_unit = controller.program.pose(state, controller.targets(which, state)[0])
    x = np.zeros(len(program.g))
    x[DDQ], x[U], x[FORCE] = command.ddq, command.u, command.force
    x[:VARIABLES] /= controller.program.qp.scale
    if len(x) > VARIABLES:
        x[DELTA] = command.relaxation / delta_unit
    return program, x


def optimality(program, x):
    """Violation of the constraints, and the gradient that no admissible multipliers balance (non-negative squares)."""
    value = program.C @ x
    violation = max(np.abs(program.A @ x - program.b).max(), (program.l - value).max(), (value - program.u).max())
    size = np.maximum(1.0, np.abs(program.C).max(axis=1))
    low, high = value - program.l < 1e-6 * size, program.u - value < 1e-6 * size
    gradient = program.H @ x + program.g
    pulls = np.vstack([program.A, -program.A, program.C[high], -program.C[low]]).T
    scale = np.maximum(np.linalg.norm(pulls, axis=0), 1e-300)
    left = nnls(pulls / scale, -gradient)[1]
    return float(violation), float(left / max(1.0, np.abs(program.g).max()))


def least_violation(program):
    """Phase 1 of a linear program: the smallest t for which some x oversteps no inequality by more than t."""
    n = len(program.g)
    low, high = program.l > -0.1 * UNBOUNDED, program.u < 0.1 * UNBOUNDED
    rows = np.vstack([-program.C[low], program.C[high]])
    result = linprog(
        np.r_[np.zeros(n), 1.0],
        A_ub=np.c_[rows, -np.ones(len(rows))],
        b_ub=np.r_[-program.l[low], program.u[high]],
        A_eq=np.c_[program.A, np.zeros(len(program.b))],
        b_eq=program.b,
        bounds=[(None, None)] * n + [(0.0, None)],
        method="highs",
    )
    assert result.status == 0, result.message
    return float(result.fun)


def adversarial(gait, count, seed):
    """States up to a radian off the virtual constraints, slow and fast."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        which = StepPhase(rng.choice(["rising", "falling"]))
        phase = gait.rising if which is StepPhase.RISING else gait.falling
        size = 10.0 ** rng.uniform(-3.0, 0.0)
        beta = phase.beta_start + rng.uniform(-0.1, 1.1) * phase.range
        h_d, h_d1, *_ = phase.desired(beta)
        rate = 2.0 * size * rng.normal()
        q = np.r_[beta, h_d + size * rng.normal(size=3)]
        yield which, q, np.r_[rate, h_d1 * rate + 10.0 * size * rng.normal(size=3)]


@pytest.mark.parametrize("outputs", ["linearising", pytest.param("clf", marks=pytest.mark.slow)])
def test_a_thousand_adversarial_states(biped, reference_gait, outputs):
    """Each is solved, and then optimal; or reported, and then no torques keep every limit. None is silent."""
    settings = ControllerSettings(frequency=60.0, joint_rate=60.0, outputs=outputs)
    controller = QpController(biped, reference_gait, settings)
    for which, q, dq in adversarial(reference_gait, 1000, seed=11):
        command = controller.command(which, q, dq)
        program, x = posed(controller, which, q, dq, command)
        if command.solved:
            violation, gradient = optimality(program, x)
            assert violation < FEASIBLE
            assert gradient < STATIONARY
        else:
            assert least_violation(program) > NEARLY
        assert np.all(np.abs(command.u) <= biped.max_torque)
    counts = controller.counts
    assert controller.ticks == 1000
    assert counts[Source.CLOSED_FORM] + counts[Source.PROGRAM] + controller.relaxed + controller.held == 1000
    assert min(counts[Source.CLOSED_FORM], counts[Source.PROGRAM], controller.relaxed) > 50  # of every kind


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
def test_an_answer_does_not_depend_on_the_tick_before(biped, reference_gait, outputs):
    """What the last tick was only says where to look first: after it, or asked first, the digits are the same."""
    settings = ControllerSettings(frequency=60.0, joint_rate=60.0, outputs=outputs)
    controller, changes, before = QpController(biped, reference_gait, settings), set(), None
    for which, q, dq in adversarial(reference_gait, 200, seed=12):
        command = controller.command(which, q, dq)
        alone = QpController(biped, reference_gait, settings).command(which, q, dq)
        assert command.source is alone.source
        for found, expected in zip(
            (command.u, command.ddq, command.force), (alone.u, alone.ddq, alone.force), strict=True
        ):
            assert np.array_equal(found, expected)
        changes.add((before, command.source))
        before = command.source
    solved = {Source.CLOSED_FORM, Source.PROGRAM}
    assert {(a, b) for a in solved for b in solved} <= changes


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
def test_kkt_over_a_run_with_active_limits(biped, level_gait, outputs):
    """Weak motors and a start off the gait: multipliers that ProxQP never saw balance the gradient at every tick."""
    settings = ControllerSettings(frequency=100.0, max_torque=(9.0, 25.0, 25.0, 9.0), outputs=outputs)
    controller = QpController(biped, level_gait, settings)
    q, dq = level_gait.state_after_impact()
    x = np.r_[q + np.array([0.0, 0.02, -0.02, 0.02]), dq]
    worst = np.zeros(2)
    for _ in range(100):
        command = controller.command(StepPhase.RISING, x[:4], x[4:])
        assert command.solved
        if command.source is Source.PROGRAM:
            worst = np.maximum(worst, optimality(*posed(controller, StepPhase.RISING, x[:4], x[4:], command)))
        x = x + 1e-3 * np.r_[x[4:], biped.forward_dynamics(x[:4], x[4:], command.u)]
    assert controller.counts[Source.PROGRAM] > 20
    assert worst[0] < FEASIBLE
    assert worst[1] < STATIONARY


@pytest.mark.parametrize("outputs", ["linearising", "clf"])
def test_a_posed_program_stays_that_of_its_state(biped, reference_gait, outputs):
    settings = ControllerSettings(joint_rate=60.0, outputs=outputs, solver="proxqp")
    controller = QpController(biped, reference_gait, settings)
    q, dq = reference_gait.state_after_impact()

    def pose(state):
        return controller.program.pose(state, controller.targets(StepPhase.RISING, state)[0]).program

    first = pose(State(q, dq))
    kept = [part.copy() for part in first]
    second = pose(State(q + 0.05, dq))
    controller.command(StepPhase.RISING, q - 0.05, dq)
    assert all(map(np.array_equal, first, kept))
    assert not np.array_equal(first.A, second.A)  # the states do differ


# ---------------------------------------------------------------------- what happens where there is no solution
def test_relaxed_torques_give_way_as_little_as_need_be(biped, reference_gait):
    """Near the least violation that any torques can reach, the motors' limits kept; and the controller says so."""
    controller = QpController(biped, reference_gait)
    found = 0
    for which, q, dq in adversarial(reference_gait, 300, seed=4):
        command = controller.command(which, q, dq)
        if command.source is not Source.RELAXED:
            continue
        found += 1
        w = biped.inverse_dynamics(q, dq, biped.forward_dynamics(q, dq, command.u))
        assert_close(command.force, w[:2], 1e-4, floor=biped.weight)  # physics is never relaxed
        program, x = posed(controller, which, q, dq, command)
        value = program.C @ x
        overstepped = max((program.l - value).max(), (value - program.u).max())
        # the sum of squares over five contact rows against the largest of them, and what the task's weight takes
        assert overstepped <= 5**0.5 * least_violation(program) + 0.1
    assert found > 10


def test_infeasible_ticks_are_logged(biped, reference_gait, caplog):
    controller = QpController(biped, reference_gait)
    q, _ = reference_gait.state_after_impact()
    with caplog.at_level(logging.INFO, logger="frontal_biped.control"):
        controller.command(StepPhase.RISING, q, np.array([15.0, -15.0, 0.0, 0.0]))
    assert len(caplog.records) == 1
    assert "rising phase" in caplog.text and "limits overstepped" in caplog.text
    assert (controller.relaxed, controller.held, controller.unsolved) == (1, 0, 1)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_what_is_no_state_holds_the_last_command(biped, reference_gait, caplog, bad):
    controller = QpController(biped, reference_gait)
    q, dq = reference_gait.state_after_impact()
    first = controller.command(StepPhase.RISING, q, np.full(4, bad))
    assert first.source is Source.HELD
    assert np.array_equal(first.u, np.zeros(4))  # nothing to hold yet
    last = controller.command(StepPhase.RISING, q, dq)
    with caplog.at_level(logging.INFO, logger="frontal_biped.control"):
        held = controller.command(StepPhase.RISING, q, np.array([dq[0], bad, 0.0, 0.0]))
    assert held.source is Source.HELD and not held.solved
    assert np.array_equal(held.u, last.u)
    assert "last command held" in caplog.text
    assert controller.held == 2
    assert controller.command(StepPhase.RISING, q, dq).solved  # and recovers
