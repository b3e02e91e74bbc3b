"""Robots with errors: laws of mechanics still hold, and no error at all is the robot of the files."""

import pickle

import numpy as np
import pytest

from frontal_biped.exceptions import RobotError
from frontal_biped.model.impact import impact
from frontal_biped.model.perturbation import LINKS, ModelErrors, Plant, perturbed
from frontal_biped.model.stance_map import Stance, relabel

EXACT = 1e-12  # rounding of matrices with entries around 10


def states(count, seed=0):
    rng = np.random.default_rng(seed)
    return [(-0.5 * np.pi + rng.uniform(-0.4, 0.4, 4), rng.normal(size=4)) for _ in range(count)]


@pytest.fixture(scope="module")
def errors():
    return ModelErrors.draw(np.random.default_rng(3), mass=0.2, com=0.02, inertia=0.2, length=0.02)


@pytest.mark.parametrize("stance", Stance)
def test_no_error_is_the_robot_of_the_files(robot, stance):
    same = perturbed(robot, ModelErrors(), stance)
    for q, dq in states(5):
        assert np.allclose(same.D(q), robot.D(q), atol=EXACT)
        assert np.allclose(same.bias(q, dq), robot.bias(q, dq), atol=EXACT * 100)
        assert np.allclose(same.swing_sole(q), robot.swing_sole(q), atol=EXACT)


@pytest.mark.parametrize("stance", Stance)
def test_mass_matrix_stays_positive_and_power_balances(biped, errors, stance):
    plant = perturbed(biped, errors, stance)
    for q, dq in states(20):
        D = plant.D(q)
        assert np.allclose(D, D.T, atol=EXACT)
        assert np.linalg.eigvalsh(D)[0] > 0.0
        u = np.array([5.0, -20.0, 10.0, 1.0])
        ddq = plant.forward_dynamics(q, dq, u)
        h = 1e-5
        change = plant.energy(q + h * dq + 0.5 * h**2 * ddq, dq + h * ddq) - plant.energy(
            q - h * dq + 0.5 * h**2 * ddq, dq - h * ddq
        )
        assert change / (2.0 * h) == pytest.approx(dq @ u, abs=1e-5)  # dE/dt = dq' u, central difference


def test_both_feet_see_one_mechanism(biped, errors):
    """Masses and distances between the joints do not depend on the foot that the coordinates are counted from."""
    plant = Plant.of(biped, errors)
    assert plant.left.mass == pytest.approx(plant.right.mass, rel=1e-12)
    assert plant.left.mass == pytest.approx(
        sum(f * b.mass for f, b in zip(errors.mass, biped.chain.bodies, strict=True))
    )
    for q, _ in states(5):
        left, right = plant.left.joint_positions(q), plant.right.joint_positions(relabel(q))
        distances = [np.linalg.norm(p[:, None] - p[None, :], axis=2) for p in (left, right[::-1])]
        assert np.allclose(*distances, atol=EXACT)


def test_impact_of_unequal_legs_conserves_angular_momentum_about_the_landing_foot(biped, errors):
    """The impulse acts at the landing foot: sigma about it is the same before, and after in the other's coordinates."""
    plant = Plant.of(biped, errors)
    for q, dq in states(5):
        landed = impact(plant.left, q, dq)
        # the landing foot has to be flat for the other robot to stand on it
        q_flat = q.copy()
        q_flat[3] -= plant.left.swing_foot_rotation(q)
        landed = impact(plant.left, q_flat, dq)
        ankle = plant.left.joint_positions(q_flat)[3]
        before = plant.left.momentum_map(q_flat)[:3] @ dq
        about = before[2] - ankle[0] * before[1] + (ankle[1] - plant.left.ankle_height) * before[0]
        # seen from the other side, the plane is mirrored: angular momentum changes its sign; the moment of the
        # impulse about the sole point is what changes it
        after = plant.right.sigma(landed.q_plus, landed.dq_plus)
        assert -after == pytest.approx(about + landed.impulse[2], abs=1e-9)
        assert landed.friction_used == pytest.approx(abs(landed.impulse[0]) / landed.impulse[1]) or (
            landed.impulse[1] <= 0.0 and landed.friction_used == np.inf
        )


def test_draws_are_repeatable_and_keep_their_order(biped):
    one, same = (ModelErrors.draw(np.random.default_rng(7), mass=0.1, com=0.01) for _ in range(2))
    assert one.as_dict() == same.as_dict()
    # a bound of its own does not shift the other draws
    more = ModelErrors.draw(np.random.default_rng(7), mass=0.1, com=0.01, inertia=0.3, length=0.1)
    assert np.array_equal(one.mass, more.mass)
    assert np.array_equal(one.com, more.com)
    assert np.all(np.abs(one.mass - 1.0) <= 0.1)
    assert np.max(np.abs(one.com)) <= 0.01
    assert np.all(one.inertia == 1.0)


def test_longer_left_leg_lifts_the_left_hip(biped):
    longer = ModelErrors(length=np.array([1.05, 1.0]))
    assert perturbed(biped, longer).leg_length == pytest.approx(1.05 * biped.leg_length)
    assert perturbed(biped, longer, Stance.RIGHT).leg_length == pytest.approx(biped.leg_length)


def test_pickles_with_its_errors(biped, errors):
    plant = perturbed(biped, errors, Stance.RIGHT)
    again = pickle.loads(pickle.dumps(plant))
    q, _ = states(1)[0]
    assert np.array_equal(again.D(q), plant.D(q))
    assert again.fingerprint == plant.fingerprint != biped.fingerprint


@pytest.mark.parametrize(
    ("values", "complaint"),
    [
        ({"mass": np.zeros(5)}, "mass.*positive"),
        ({"mass": np.ones(4)}, "shape"),
        ({"com": np.full((5, 2), np.nan)}, "com.*finite"),
        ({"length": np.array([1.0, -1.0])}, "length.*positive"),
    ],
)
def test_impossible_errors_are_refused(values, complaint):
    with pytest.raises(RobotError, match=complaint):
        ModelErrors(**values)


def test_times_multiplies_factors_and_adds_shifts():
    both = ModelErrors(mass=np.full(5, 1.1), com=np.full((5, 2), 0.01)).times(ModelErrors(mass=np.full(5, 2.0)))
    assert np.allclose(both.mass, 2.2)
    assert np.allclose(both.com, 0.01)
    assert len(LINKS) == 5
    assert both.any
    assert not ModelErrors().any
    assert ModelErrors.from_dict(both.as_dict()).as_dict() == both.as_dict()
