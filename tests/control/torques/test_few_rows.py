"""The common ticks in one function: the answers of the exact solver, found another way; compiled or not, the same.

The function is run uncompiled here, so that these laws hold without Numba too.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from random_states import assert_close, vectors

from frontal_biped.control import ControllerSettings, QpController, Source
from frontal_biped.control.settings import OUTPUTS
from frontal_biped.control.torques import few_rows
from frontal_biped.control.torques.few_rows import FewRows, compiled, few_active_rows
from frontal_biped.control.torques.linearisation import StanceModel, Targets
from frontal_biped.exceptions import MissingExtraError
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints import StepPhase

SAME = 1e-6
"""Relative agreement of torques and accelerations: a row may be missed by 1e-9 of its unit."""

SETTINGS = [
    ControllerSettings(frequency=60.0),
    ControllerSettings(frequency=60.0, joint_rate=60.0, max_torque=(8.0, 45.0, 45.0, 8.0)),
]


@pytest.fixture(scope="module", params=SETTINGS, ids=["contact", "joints and weak motors"])
def controllers(request, biped, reference_gait):
    """Exact, and with the common ticks in one function."""
    exact, few = (QpController(biped, reference_gait, request.param) for _ in range(2))
    few.program._few_rows = FewRows(few.program._nearest, few_active_rows)
    return exact, few


def state(gait, which, s, y, dy):
    """Off the virtual constraints by y and dy, at half the gait's speed."""
    phase = gait.rising if which is StepPhase.RISING else gait.falling
    beta = phase.beta_start + s * phase.range
    h_d, h_d1, *_ = phase.desired(beta)
    rate = which.sign * 0.5 * gait.orbit.beta_dot_after_impact
    return State(np.r_[beta, h_d + y], np.r_[rate, h_d1 * rate + dy])


off = {
    "which": st.sampled_from(list(StepPhase)),
    "s": st.floats(0.0, 1.0),
    "y": vectors(-0.02, 0.02, 3),
    "dy": vectors(-0.3, 0.3, 3),
}


@given(**off)
def test_what_is_found_is_the_optimum(controllers, reference_gait, which, s, y, dy):
    exact, few = controllers
    at = state(reference_gait, which, s, y, dy)
    dynamics, targets = StanceModel(exact.biped).at(at), exact.targets(which, at)[0]
    found = few.program._few_rows.solve(dynamics, targets)
    assume(found is not None)
    motion, limited = found
    theirs = exact.program.solve(at, targets)
    assert theirs.source is (Source.PROGRAM if limited else Source.CLOSED_FORM)
    assert_close(motion.ddq, theirs.ddq, SAME, floor=1.0 + np.max(np.abs(theirs.ddq)))
    assert_close(motion.forces[3:], theirs.u, SAME, floor=exact.program.qp.torque_unit)
    assert_close(motion.forces[:2], theirs.force, SAME, floor=exact.biped.weight)


@given(ddy=vectors(-40.0, 40.0, 3), q=vectors(-1.65, -1.45, 4), dq=vectors(-0.5, 0.5, 4), p_fri=st.floats(-0.03, 0.03))
def test_over_the_sway(controllers, ddy, q, dq, p_fri):
    exact, few = controllers
    at = State(q, dq)
    dynamics = StanceModel(exact.biped).at(at)
    sway = dynamics.sway(exact.biped.mass)
    targets = Targets(np.array([1.0, -1.5, 0.5]), np.zeros(3), ddy, p_fri, sway=sway)
    found = few.program._few_rows.solve(dynamics, targets)
    assume(found is not None)
    theirs = exact.program.solve(at, targets)
    assert theirs.source is (Source.PROGRAM if found[1] else Source.CLOSED_FORM)
    assert_close(found[0].ddq, theirs.ddq, SAME, floor=1.0 + np.max(np.abs(theirs.ddq)))


def test_most_ticks_are_found(controllers, reference_gait):
    """And the others are answered all the same; or the tests above would see nothing."""
    rng = np.random.default_rng(3)
    exact, few = controllers
    found, limited = 0, 0
    for i in range(200):
        which = list(StepPhase)[i % 2]
        at = state(reference_gait, which, rng.uniform(), 0.02 * rng.normal(size=3), 0.1 * rng.normal(size=3))
        answer = few.program._few_rows.solve(StanceModel(exact.biped).at(at), exact.targets(which, at)[0])
        found += answer is not None
        limited += answer is not None and answer[1]
        theirs, ours = exact.command(which, *at), few.command(which, *at)
        assert ours.source is theirs.source
        assert_close(ours.u, theirs.u, SAME, floor=exact.program.qp.torque_unit)
    assert found >= 150
    assert limited >= 50


def test_nothing_is_found_where_limits_contradict_each_other(biped, reference_gait):
    """A robot asked to press on the ground with twice what its motors can."""
    settings = ControllerSettings(max_torque=(0.1, 0.1, 0.1, 0.1), min_normal_force=1.5)
    controller = QpController(biped, reference_gait, settings)
    at = state(reference_gait, StepPhase.FALLING, 0.5, np.zeros(3), np.zeros(3))
    few = FewRows(controller.program._nearest, few_active_rows)
    dynamics, targets = StanceModel(biped).at(at), controller.targets(StepPhase.FALLING, at)[0]
    assert controller.program.solve(at, targets).source is Source.RELAXED
    assert few.solve(dynamics, targets) is None


@pytest.mark.parametrize("broken", ["M", "bias", "p_fri"])
def test_what_is_not_a_number_is_not_found(controllers, reference_gait, broken):
    exact, few = controllers
    at = state(reference_gait, StepPhase.RISING, 0.5, np.zeros(3), np.zeros(3))
    dynamics, targets = StanceModel(exact.biped).at(at), exact.targets(StepPhase.RISING, at)[0]
    if broken == "p_fri":
        targets = targets._replace(p_fri=np.nan)
    else:
        dynamics = dynamics._replace(**{broken: np.nan * getattr(dynamics, broken)})
    assert few.program._few_rows.solve(dynamics, targets) is None


def test_a_lyapunov_function_is_left_to_the_exact_solver(biped, reference_gait):
    assert "clf" in OUTPUTS
    controller = QpController(biped, reference_gait, ControllerSettings(outputs="clf"))
    at = state(reference_gait, StepPhase.RISING, 0.5, np.zeros(3), np.zeros(3))
    few = FewRows(controller.program._nearest, few_active_rows)
    assert few.solve(StanceModel(biped).at(at), controller.targets(StepPhase.RISING, at)[0]) is None


def test_without_numba_the_remedy_is_told(biped, reference_gait, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(few_rows, "import_module", missing)
    compiled.cache_clear()
    with pytest.raises(MissingExtraError, match=r"needs Numba: .*frontal-biped\[compiled\]"):
        QpController(biped, reference_gait, ControllerSettings(solver="compiled"))
    compiled.cache_clear()


def test_compiled_answers_are_the_uncompiled_ones(biped, reference_gait):
    pytest.importorskip("numba")
    settings = ControllerSettings(frequency=60.0)
    ours = QpController(biped, reference_gait, replace(settings, solver="compiled"))
    plain = QpController(biped, reference_gait, settings)
    plain.program._few_rows = FewRows(plain.program._nearest, few_active_rows)
    rng = np.random.default_rng(3)
    for i in range(100):
        which = list(StepPhase)[i % 2]
        at = state(reference_gait, which, rng.uniform(), 0.02 * rng.normal(size=3), 0.1 * rng.normal(size=3))
        a, b = ours.command(which, *at), plain.command(which, *at)
        assert a.source is b.source
        assert_close(a.u, b.u, 1e-9, floor=ours.program.qp.torque_unit)
