"""Symbols of the terminal as HTML."""

import pytest

from frontal_biped.demo.typeset import typeset


@pytest.mark.parametrize(
    ("plain", "shown"),
    [
        ("multiplier delta_f^2", "multiplier δ<sub>f</sub><sup>2</sup>"),
        ("kg^2 m^4/s^2", "kg<sup>2</sup> m<sup>4</sup>/s<sup>2</sup>"),
        ("Reversal β_r-", "Reversal β<sub>r</sub><sup>−</sup>"),
        ("Fixed point ζ_f*", "Fixed point ζ<sub>f</sub><sup>*</sup>"),
        ("1.5e-13", "1.5 × 10<sup>−13</sup>"),
        ("-6 % to +30 %", "−6 % to +30 %"),
        ("max_pelvis_roll of frontal_biped", "max_pelvis_roll of frontal_biped"),
        ("post-impact & <b>", "post-impact &amp; &lt;b&gt;"),
    ],
)
def test_a_line_is_set_as_in_the_paper(plain, shown):
    assert typeset(plain) == shown
