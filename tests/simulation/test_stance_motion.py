"""A step under held torques is the classical Runge-Kutta step, pushed or not."""

import numpy as np
import pytest

from frontal_biped.model import Stance, State
from frontal_biped.simulation.pushes import PelvisForce
from frontal_biped.simulation.stance_motion import StanceMotion

U = np.array([5.0, 30.0, -20.0, 1.0])  # [N m]


def textbook(derivative, x, h):
    """The step of order 4 on a system of first order."""
    k_1 = derivative(x)
    k_2 = derivative(x + 0.5 * h * k_1)
    k_3 = derivative(x + 0.5 * h * k_2)
    k_4 = derivative(x + h * k_3)
    return x + h / 6.0 * (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4)


@pytest.mark.parametrize("pushes", [[], [(80.0, 0.1), (-30.0, 0.0)]])
@pytest.mark.parametrize("h", [1e-3, 3.7e-4])
def test_it_is_the_textbook_step(biped, reference_gait, pushes, h):
    motion, pelvis = StanceMotion(biped, Stance.RIGHT), PelvisForce(biped)
    motion.u, motion.pushes = U, pushes

    def derivative(x):
        q, dq = x[:4], x[4:]
        pushed = sum((pelvis.torques(q, force, height) for force, height in pushes), np.zeros(4))
        return np.concatenate([dq, np.linalg.solve(biped.D(q), U + pushed - biped.bias(q, dq))])

    state = State(*reference_gait.state_after_impact())
    x = np.concatenate(state)
    for _ in range(5):
        state, x = motion.advance(state, h), textbook(derivative, x, h)
    np.testing.assert_allclose(np.concatenate(state), x, rtol=1e-11, atol=1e-12)


def test_a_state_stays_what_it_was_when_the_next_one_is_known(biped, reference_gait):
    motion = StanceMotion(biped, Stance.LEFT)
    motion.u = U
    first = motion.advance(State(*reference_gait.state_after_impact()), 1e-3)
    kept = np.concatenate(first)
    motion.advance(first, 1e-3)
    np.testing.assert_array_equal(np.concatenate(first), kept)


@pytest.mark.parametrize("pushes", [[], [(80.0, 0.1)]])
def test_an_acceleration_that_is_known_is_the_one_that_would_be_found(biped, reference_gait, pushes):
    motion, state = StanceMotion(biped, Stance.LEFT), State(*reference_gait.state_after_impact())
    motion.u, motion.pushes = U, pushes
    ddq = motion.acceleration(state)
    assert motion.reaction(state, ddq) == motion.reaction(state)
    for known, found in zip(motion.advance(state, 1e-3, ddq), motion.advance(state, 1e-3), strict=True):
        np.testing.assert_array_equal(known, found)
    forces = biped.inverse_dynamics(*state, ddq)[:3]
    carried = sum((np.array([force, 0.0, -force * motion._pelvis.height(state.q, h)]) for force, h in pushes), 0.0)
    F_h, F_v, N_0 = forces - carried
    assert motion.reaction(state) == pytest.approx((F_h, F_v, N_0 / F_v), rel=1e-11)
