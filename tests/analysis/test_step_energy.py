"""Energies read from walks in space that are known."""

import numpy as np
import pytest
from swept_walk import swept_walk

from frontal_biped.analysis.step_energy import frontal_energy, step_energies
from frontal_biped.gait import load_gait
from frontal_biped.model import load_robot, models_dir

SAMPLED = 2e-3
"""Relative to the orbit's energy, of nine samples out of ten: velocities of a swept walk are differences of its poses,
5 ms apart, and where a step begins and ends they are one-sided and the joints' accelerations jump."""


@pytest.fixture(scope="module")
def walker():
    return load_robot("romeo_bent"), load_gait(models_dir() / "romeo_bent.gait.json")


def test_on_the_spot_it_is_the_orbit(walker):
    robot, gait = walker
    run = swept_walk(robot, gait, steps=2, step_length=0.0)
    found = step_energies(robot, gait, run)
    np.testing.assert_allclose(found.beta, run.frontal_q[:, 0], atol=1e-8)
    assert np.quantile(np.abs(found.error), 0.9) < SAMPLED
    energy = frontal_energy(robot, gait)
    assert found.orbit == energy.orbit
    beyond = found.barrier_margin - (energy.barrier / energy.orbit - 1.0)
    assert np.quantile(np.abs(beyond), 0.9) < SAMPLED


def test_where_it_walks_to_does_not_matter(walker):
    """Laid on a circle, the same walk has the same energies."""
    robot, gait = walker
    straight, turned = (step_energies(robot, gait, swept_walk(robot, gait, 2, 0.05, turn)) for turn in (0.0, 1e-6))
    np.testing.assert_allclose(turned.zeta, straight.zeta, atol=1e-4 * straight.orbit)
    np.testing.assert_allclose(turned.beta, straight.beta, atol=1e-6)


def test_legs_that_swing_forward_change_it_little(walker):
    """Virtual legs do not know x, and of the angular momentum about it only what the knees move besides."""
    robot, gait = walker
    spot, walk = (step_energies(robot, gait, swept_walk(robot, gait, 2, length)) for length in (0.0, 0.1))
    np.testing.assert_allclose(walk.beta, spot.beta, atol=1e-6)
    change = np.abs(walk.error - spot.error)
    assert 1e-5 < np.quantile(change, 0.9) < SAMPLED
