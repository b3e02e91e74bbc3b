"""Dynamics of many states in one call are those of each of them."""

import numpy as np
import pytest

ROUNDING = 1e-11  # [rad/s^2], [N], [N m] of numbers up to some thousands


@pytest.mark.parametrize("count", [1, 2, 17])
def test_rows_are_the_answers_for_single_states(biped, count):
    rng = np.random.default_rng(count)
    q = rng.uniform(-2.0, -1.2, (count, 4))
    dq, given = rng.normal(size=(2, count, 4))
    u = 20.0 * given
    ddq = biped.many.forward_dynamics(q, dq, u)
    forces = biped.many.inverse_dynamics(q, dq, ddq)
    assert ddq.shape == (count, 4)
    assert forces.shape == (count, 7)
    for i in range(count):
        assert ddq[i] == pytest.approx(biped.forward_dynamics(q[i], dq[i], u[i]), abs=ROUNDING)
        assert forces[i] == pytest.approx(biped.inverse_dynamics(q[i], dq[i], ddq[i]), abs=ROUNDING)
    assert forces[:, 3:] == pytest.approx(u, abs=1e-9)


def test_every_robot_stands_on_its_foot_as_for_one_state(robot):
    q, dq, ddq = np.random.default_rng(3).normal(size=(3, 4, 4))
    expected = [robot.inverse_dynamics(*at) for at in zip(q, dq, ddq, strict=True)]
    np.testing.assert_allclose(robot.many.inverse_dynamics(q, dq, ddq), expected, rtol=0.0, atol=ROUNDING)


def test_several_accelerations_at_each_state(biped):
    q, dq, *ddq = np.random.default_rng(4).normal(size=(4, 3, 4))
    forces = biped.many.inverse_dynamics(q, dq, np.array(ddq))
    np.testing.assert_array_equal(forces, [biped.many.inverse_dynamics(q, dq, one) for one in ddq])


def test_columns_of_other_arrays_are_rows_too(biped):
    """Slices of a trajectory (T, 8) are not contiguous."""
    x = np.random.default_rng(0).uniform(-1.5, -1.0, (5, 8))
    u = np.zeros((5, 4))
    whole = biped.many.forward_dynamics(x[:, :4].copy(), x[:, 4:].copy(), u)
    assert (biped.many.forward_dynamics(x[:, :4], x[:, 4:], u) == whole).all()


def test_what_the_robot_hands_out_is_the_callers_own(biped):
    rng = np.random.default_rng(1)
    first, second = rng.uniform(-2.0, -1.2, (2, 4))
    rates = rng.normal(size=4)
    asked = [
        lambda q: biped.D(q),
        lambda q: biped.bias(q, rates),
        lambda q: biped.forward_dynamics(q, rates, rates),
        lambda q: biped.inverse_dynamics(q, rates, rates),
        lambda q: biped.com(q),
        lambda q: biped.floating_mass_matrix(q),
        lambda q: biped.C(q, rates),
        lambda q: biped.G(q),
    ]
    for ask in asked:
        kept = ask(first)
        was = kept.copy()
        ask(second)
        assert (kept == was).all()
