"""The figure of proved zeros."""

import re

import pytest
from figure_laws import assert_fit_for_a_column

from frontal_biped.figures.proof import proved_zeros


@pytest.mark.slow
def test_every_proved_zero_is_drawn(biped, reference_certificate):
    certificate = reference_certificate
    figure = proved_zeros(biped, certificate)
    assert_fit_for_a_column(figure)
    upper, lower = figure.get_axes()
    proof = certificate.proof
    for ax, zeros in ((upper, proof.fixed.found.zeros), (lower, proof.imposed.places)):
        assert re.search(r"\[.+\]", ax.get_ylabel())
        drawn = sorted(x for line in ax.get_lines() if line.get_linestyle() == "None" for x in line.get_xdata())
        inside = [1e3 * (end - certificate.gait.beta_reversal) for zero in zeros for end in zero]
        assert len(drawn) == len(zeros)
        for x, low, high in zip(drawn, inside[::2], inside[1::2], strict=True):
            assert low <= x <= high
    assert "[mrad]" in lower.get_xlabel()
