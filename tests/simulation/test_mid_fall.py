"""The speed half-way down, measured and in closed form."""

from dataclasses import replace

import numpy as np
import pytest

from frontal_biped.simulation.mid_fall import speed_errors
from frontal_biped.simulation.walking import simulate

SAMPLED = 1e-6
"""What a cubic between samples 4 ms apart leaves of a speed [-]."""


def test_speed_on_the_orbit_itself_is_the_closed_form(biped, reference_gait):
    run = simulate(biped, reference_gait, steps=2, period=None)
    errors = speed_errors(biped, reference_gait, run)
    assert len(errors) == 2
    assert np.max(np.abs(errors)) < SAMPLED


def test_a_faster_start_is_seen(biped, reference_gait):
    """An error of the speed dies out by the multiplier, step by step, wherever on the orbit it is measured."""
    run = simulate(biped, reference_gait, steps=3, period=None, speed_error=0.002)
    errors = speed_errors(biped, reference_gait, run)
    assert errors[1:] / errors[:-1] == pytest.approx(reference_gait.orbit.multiplier, rel=0.05)
    assert errors[0] > 0.0


def test_steps_that_begin_beyond_half_way_are_left_out(biped, reference_gait):
    """A falling phase may begin there, or leave a single sample: no speed is made up."""
    run = simulate(biped, reference_gait, steps=2, period=None)
    late = (run.step == 0) & (run.phase < 0.0)
    end = np.flatnonzero(late)[-1]
    for kept in (1, 3):
        keep = ~late | (np.arange(len(run.t)) > end - kept)
        cut = replace(run, **{name: getattr(run, name)[keep] for name in ("t", "q", "dq", "phase", "step")})
        assert len(speed_errors(biped, reference_gait, cut)) == 1


def test_a_gait_without_an_orbit_has_no_speed_to_compare_with(biped, reference_gait):
    """A file may hold one: here the stance hip falls from somewhere else than where it rose to."""
    run = simulate(biped, reference_gait, steps=1, period=None)
    columns = reference_gait.falling.joint_bezier.copy()
    columns[0, 0] = 0.0
    spoilt = replace(reference_gait, falling=replace(reference_gait.falling, joint_bezier=columns))
    assert len(speed_errors(biped, spoilt, run)) == 0
