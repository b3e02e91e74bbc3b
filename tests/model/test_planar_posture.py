"""What tells events apart, from one pass over the kinematics, is what the single questions answer."""

import numpy as np
import pytest


def test_posture_is_centre_of_mass_and_swing_sole(biped):
    rng = np.random.default_rng(2)
    for q in rng.uniform(-2.2, -1.0, (20, 4)):
        at = biped.posture(q)
        assert (at.com_h, at.com_v) == pytest.approx(tuple(biped.com(q)), abs=1e-14)
        assert (at.inner_v, at.outer_v) == pytest.approx(tuple(biped.swing_sole(q)[:, 1]), abs=1e-14)
        assert min(at.inner_v, at.outer_v) == pytest.approx(biped.swing_clearance(q), abs=1e-14)


def test_posture_does_not_depend_on_what_was_asked_before(biped):
    """It shares Pinocchio's work data with the dynamics, and its views are of that."""
    first, second = np.random.default_rng(3).uniform(-2.0, -1.2, (2, 4))
    before = biped.posture(first)
    biped.inverse_dynamics(second, second, second)
    biped.energy(second, second)
    biped.posture(second)
    assert biped.posture(first) == before
