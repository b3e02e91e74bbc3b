"""Whether a robot tips over, from where it is on Z: the barrier of its phase, wherever in the phase it is asked."""

import numpy as np
import pytest

from frontal_biped.analysis.tipping import comes_over_the_barrier
from frontal_biped.control.stabilisers.transitions import ReanchoringTransitions
from frontal_biped.model.state import State
from frontal_biped.zero_dynamics.half_steps import rising_energy
from frontal_biped.zero_dynamics.restricted import on_constraints


@pytest.fixture(scope="module")
def rising(biped, level_gait):
    return ReanchoringTransitions(biped, level_gait).planned_rising


def on_the_way(biped, rising, beta, zeta_start):
    """The state at beta [rad] of a robot that began the phase with an energy [kg^2 m^4/s^2]."""
    growth, spent = rising_energy(biped, rising).at(beta)
    motion, restricted = on_constraints(biped, rising, np.array([beta]))
    dbeta = np.sqrt(2.0 * np.exp(growth) * (zeta_start - spent)) / restricted.I_P[0]
    return State(motion.q[0], motion.dq[0] * dbeta)


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0, 1.5])
def test_a_robot_tips_with_more_than_the_barrier(biped, rising, share):
    barrier = rising_energy(biped, rising).highest
    beta = rising.beta_start + share * rising.range
    for factor in (0.999, 1.001):
        state = on_the_way(biped, rising, beta, factor * barrier)
        assert comes_over_the_barrier(biped, rising, state) == (factor > 1.0)


def test_before_the_phase_nothing_is_said_and_beyond_the_barrier_it_has_tipped(biped, rising):
    energy = rising_energy(biped, rising)
    assert energy.reaches_barrier
    for beta, tips in ((energy.start - 0.01, False), (energy.end + 0.01, True)):
        at = rising.motion(np.array([beta]))
        assert comes_over_the_barrier(biped, rising, State(at.q[0], at.dq[0])) == tips
