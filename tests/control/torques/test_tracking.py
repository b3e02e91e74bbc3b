"""Plain numbers give what the formulas give: errors, the acceleration that is asked of them, and the line for it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from random_states import assert_close, vectors

from frontal_biped.control.torques.linearisation import StanceModel, Targets, over_sway
from frontal_biped.control.torques.tracking import ErrorDynamics
from frontal_biped.model.state import State

ROUNDING = 1e-14

FREQUENCY, DAMPING = 80.0, 0.9
three = vectors(-2.0, 2.0, 3)


@given(
    q=vectors(-1.9, -1.2, 4),
    dq=vectors(-1.0, 1.0, 4),
    rate=st.floats(-1.0, 1.0),
    h_d=three,
    h_d1=three,
    h_d2=three,
)
def test_errors_and_what_is_asked_of_them(q, dq, rate, h_d, h_d1, h_d2):
    errors = ErrorDynamics(FREQUENCY, DAMPING)
    line, y, dy, ddy, curve = errors.at(q, dq, rate, h_d, h_d1, h_d2)
    assert_close(y, q[1:] - h_d, ROUNDING, floor=1.0)
    assert_close(dy, dq[1:] - h_d1 * rate, ROUNDING, floor=1.0)
    v = -(FREQUENCY**2) * y - 2.0 * DAMPING * FREQUENCY * dy
    assert_close(ddy, v, ROUNDING, floor=FREQUENCY**2)
    assert_close(errors.asked(y, dy), v, ROUNDING, floor=FREQUENCY**2)
    assert_close(curve, h_d2 * rate**2, ROUNDING, floor=1.0)
    targets = Targets(h_d1, curve, ddy, 0.0)
    np.testing.assert_array_equal(line, targets.line())
    np.testing.assert_array_equal(line[1], targets.slope())


@given(q=vectors(-1.9, -1.2, 4), dq=vectors(-1.0, 1.0, 4), h_d=three, h_d1=three, h_d2=three)
def test_the_line_over_the_sway_is_that_of_its_targets(biped, q, dq, h_d, h_d1, h_d2):
    """Its accelerations give the outputs theirs, and c moves the sway by one."""
    sway = StanceModel(biped).at(State(q, dq)).sway(biped.mass)
    line, _, _, ddy, curve = ErrorDynamics(FREQUENCY, DAMPING).at(q, dq, sway.rate, h_d, h_d1, h_d2)
    targets = Targets(h_d1, curve, ddy, 0.0, sway=sway)
    a, c = over_sway(line, sway)
    np.testing.assert_array_equal((a, c), targets.line())
    np.testing.assert_array_equal(c, targets.slope())
    size = 1.0 + np.abs(line).max()
    assert abs(sway.J @ c - 1.0) < 1e-12 * size
    assert abs(sway.J @ a + sway.drift) < 1e-12 * size
    assert_close(a[1:], ddy + curve, ROUNDING, floor=size)
