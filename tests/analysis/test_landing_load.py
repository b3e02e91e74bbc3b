"""The load of a foot that lands: a spike with an impact, none without."""

import numpy as np
import pytest
from figure_laws import assert_fit_for_a_column
from support_gaits import designed

from frontal_biped.analysis.landing_load import load_with_impact, load_without_impact
from frontal_biped.figures.landing_load import landing_load_figure

pytestmark = pytest.mark.slow

FULL_LOAD = 1.2
"""A foot that takes the weight evenly carries all of it in the end, and a fifth more for what is accelerated."""


@pytest.fixture(scope="module")
def loads(biped, reference_gait):
    pytest.importorskip("mujoco")
    return load_without_impact(biped, designed("frontal_biped").gait), load_with_impact(biped, reference_gait)


def test_no_spike_without_an_impact(loads):
    without, with_impact = loads
    assert without.peak < FULL_LOAD < with_impact.peak
    assert without.largest_jump < 0.5 * with_impact.largest_jump


def test_the_load_is_none_before_and_grows_to_the_weight(loads):
    without, _ = loads
    assert np.all(without.load[without.t < -2e-3] == 0.0)
    assert without.load[-1] > 0.5


def test_figure(loads):
    figure = landing_load_figure(*loads)
    (ax,) = figure.get_axes()
    assert "[ms]" in ax.get_xlabel()
    assert_fit_for_a_column(figure)
