"""The chain from the decimals of URDF and description, against the reduction in floating point."""

from dataclasses import fields

import numpy as np
import pytest

from frontal_biped.model.catalogue import biped_of
from frontal_biped.model.perturbation import ModelErrors, perturbed
from frontal_biped.zero_dynamics.proof.balls import arb, as_text, working
from frontal_biped.zero_dynamics.proof.chain import BallChain
from frontal_biped.zero_dynamics.proof.decimals import decimal_chain

# raised ankles, offsets, rotor inertia, legs that are averaged, virtual legs, a root that is turned
ROBOTS = [
    "frontal_biped",
    "frontal_biped_low_torso",
    "talos_full",
    "talos_bent",
    "g1",
    "g1_bent",
    "icub",
    "icub_bent",
    "romeo",
    "simple_humanoid_bent",
    "alexander",
]

ROUNDING = 1e-14
"""Of the reduction in floating point, [m], [kg], [kg m^2] and products of these; the robots weigh 30 to 100 kg."""

NARROW = 1e-50
"""Largest radius: the decimals are known to 200 bits."""


def numbers(chain):
    found = []

    def add(value):
        if isinstance(value, tuple):
            for part in value:
                add(part)
        else:
            found.append(value)

    for field in fields(chain):
        add(getattr(chain, field.name))
    return found


@pytest.mark.parametrize("name", ROBOTS)
def test_the_reduction_in_floating_point_is_near(name):
    biped = biped_of(name)
    with working():
        exact, loaded = numbers(decimal_chain(biped)), numbers(BallChain.of(biped.chain))
    assert len(exact) == len(loaded) == 34
    for ball, double in zip(exact, loaded, strict=True):
        assert ball.rad() < NARROW
        assert abs(ball - double) < ROUNDING * (1.0 + biped.mass)


def test_the_decimals_are_those_of_the_file():
    """12.15 kg, 0.4 kg m^2 and 5.53 kg m^2 are no doubles: the balls contain these, not the doubles next to them."""
    with working():
        chain = decimal_chain(biped_of("frontal_biped"))
        leg, pelvis = chain.bodies[0], chain.bodies[1]
        for ball, text in ((leg.mass, "12.15"), (leg.inertia, "0.4"), (pelvis.inertia, "5.53")):
            assert ball.overlaps(arb(text))
            assert not ball.overlaps(arb(float(text)))


def test_a_robot_with_errors_of_its_own_has_no_decimals():
    """Then the doubles are the robot."""
    other = perturbed(biped_of("frontal_biped"), ModelErrors(mass=np.full(5, 1.01)))
    with working():
        found, doubles = numbers(decimal_chain(other)), numbers(BallChain.of(other.chain))
        assert [as_text(ball) for ball in found] == [as_text(ball) for ball in doubles]
