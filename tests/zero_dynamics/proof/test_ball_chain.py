"""The chain in ball arithmetic against Pinocchio: two routes to the dynamics of seven robots."""

import numpy as np
import pytest

from frontal_biped.model.catalogue import biped_of
from frontal_biped.model.impact import impact
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.chain import BallChain, Motion, absolute, sums

ROBOTS = ["frontal_biped", "frontal_biped_low_torso", "talos_full", "g1", "icub", "romeo", "simple_humanoid_classical"]

ROUNDING = 1e-13
"""Relative error of the robot's numbers that covers the rounding of Pinocchio's algorithms."""

ANGLE = 1e-15
"""Of the states, likewise [rad], [rad/s], [rad/s^2]."""


def balls(values):
    return [arb(float(value), ANGLE) for value in values]


def states(seed, count):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        yield -0.5 * np.pi + rng.uniform(-0.6, 0.6, 4), rng.normal(0.0, 2.0, 4), rng.normal(0.0, 20.0, 4)


@pytest.mark.parametrize("count", [10, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ROBOTS)
def test_balls_contain_what_pinocchio_finds(name, count):
    biped = biped_of(name)
    with working():
        chain = BallChain.of(biped.chain, ROUNDING)
        for q, dq, ddq in states(0, count):
            there, at_rest = balls(q), balls(np.zeros(4))
            told = biped.inverse_dynamics(q, dq, ddq)
            found = chain.inverse_dynamics(Motion(there, balls(dq), balls(ddq)))
            bias = chain.inverse_dynamics(Motion(there, balls(dq), at_rest))
            momenta = chain.momenta(absolute(there), sums(balls(dq)))
            landed = chain.landed_slopes(there, [balls(dq)])[0]
            landing, impacted = impact(biped, q, dq), chain.impact(there, balls(dq))
            (_, foot_v, foot_turn), (outer, inner) = impacted.foot, biped.sole
            pairs = [
                *zip(found, told, strict=True),
                (found[2] / found[1], biped.fri(q, dq, ddq)),
                *zip(bias[3:], biped.bias(q, dq), strict=True),
                *zip(np.ravel(chain.mass_matrix(there)), np.ravel(biped.D(q)), strict=True),
                *zip(momenta.momentum, biped.momentum_map(q)[:3] @ dq, strict=True),
                (momenta.moment / chain.mass, biped.com(q)[0]),
                *zip(landed, landing.dq_plus, strict=True),
                *zip(impacted.impulse, landing.impulse, strict=True),
                *zip((foot_v + foot_turn * arb(end) for end in (inner, outer)), landing.lift_off, strict=True),
            ]
            for ball, number in pairs:
                assert ball.contains(arb(float(number)))


@pytest.mark.parametrize("name", ROBOTS)
def test_balls_are_narrow(name):
    """Containing is easy for wide ones: a millionth of what is asked of a joint is far less than any limit."""
    biped = biped_of(name)
    with working():
        chain = BallChain.of(biped.chain)
        for q, dq, ddq in states(1, 10):
            motion = Motion(*([arb(float(x)) for x in part] for part in (q, dq, ddq)))
            for ball in chain.inverse_dynamics(motion):
                assert ball.rad() < 1e-15 * (1.0 + np.abs(ddq).max()) * biped.weight


def test_another_mass_is_not_contained():
    """One gram more is seen."""
    biped, q = biped_of("frontal_biped"), -0.5 * np.pi + np.array([0.1, -0.1, 0.05, 0.0])
    heavier = biped.with_mass(biped.mass + 1e-3)
    with working():
        chain = BallChain.of(biped.chain, ROUNDING)
        found = chain.inverse_dynamics(Motion(balls(q), balls(np.zeros(4)), balls(np.zeros(4))))
        assert not found[1].contains(arb(float(heavier.inverse_dynamics(q, np.zeros(4), np.zeros(4))[1])))
