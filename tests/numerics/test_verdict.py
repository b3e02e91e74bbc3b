"""What is shown of several statements, and of a number against a bound."""

import itertools

import pytest

from frontal_biped.numerics.verdict import Verdict, below, together

YES, NO, OPEN = Verdict.CERTIFIED, Verdict.REFUTED, Verdict.UNDECIDED


def test_together_is_as_strict_as_the_strictest():
    assert together([]) is YES
    for parts in itertools.product(Verdict, repeat=3):
        expected = NO if NO in parts else OPEN if OPEN in parts else YES
        assert together(parts) is expected


@pytest.mark.parametrize(
    ("value", "error", "expected"),
    [
        (0.5, 0.1, YES), (0.95, 0.1, OPEN), (1.05, 0.1, OPEN), (1.5, 0.1, NO),
        (0.999, 0.0, YES), (1.0, 0.0, OPEN), (1.001, 0.0, NO),
        (float("nan"), 0.1, OPEN), (0.5, float("nan"), OPEN), (float("inf"), 0.1, NO),
    ],
)  # fmt: skip
def test_below_one(value, error, expected):
    assert below(value, 1.0, error) is expected
