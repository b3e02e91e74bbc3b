"""Forward mode: every rule against complex-step differentiation, and refusal of what it does not know."""

import numpy as np
import pytest

from frontal_biped.design.forward_mode import Dual, chain, elementwise, independent
from frontal_biped.design.tape import Tape

EXACT = 1e-13
"""Complex-step derivatives are exact to rounding."""

H = 1e-30
"""Imaginary step."""

X = np.array([0.7, 1.3, 0.4, 2.1, 0.9, 1.7])
MATRIX = np.array([[1.0, 2.0, -1.0], [0.5, 0.0, 3.0]])

FORMULAS = {
    "sum": lambda x: x + 2.0 * x - x[::-1],
    "constant minus": lambda x: 3.0 - x,
    "constant over": lambda x: 2.0 / x,
    "quotient": lambda x: x / (1.0 + x[::-1]),
    "product": lambda x: x * x[::-1] * x,
    "power": lambda x: x**2 + x**3 + x**-0.5,
    "root": lambda x: np.sqrt(x * x + 1.0),
    "exponential": lambda x: np.exp(-x) * np.sin(x) + np.cos(x),
    "scalar times vector": lambda x: x[0] * x[1:] - x[2],
    "vector over scalar": lambda x: x / x[3],
    "scalar times constants": lambda x: x[1] * np.arange(4.0) + np.ones(4) / x[0],
    "rows times vector": lambda x: np.stack([x, 2.0 * x]) * x,
    "scalar times rows": lambda x: np.stack([x, x * x]) / x[0],
    "constant rows": lambda x: x * np.arange(12.0).reshape(2, 6),
    "added constant rows": lambda x: x + np.arange(12.0).reshape(2, 6),
    "constant matrix, left": lambda x: MATRIX @ x[:3],
    "constant matrix, right": lambda x: x[:2] @ MATRIX,
    "matrix product": lambda x: x.reshape(2, 3) @ MATRIX.T,
    "constant left of a matrix": lambda x: MATRIX @ x.reshape(3, 2),
    "transpose": lambda x: x.reshape(2, 3).T * x[0],
    "columns": lambda x: x.reshape(2, 3)[:, 1:] - x[:2][:, None],
    "joined": lambda x: np.concatenate([x, np.ones(2), x[:1]]),
    "sum over rows": lambda x: (x.reshape(2, 3) ** 2).sum(axis=0),
    "smaller of two": lambda x: np.minimum(x, x[::-1] ** 2),
    "smaller of one and constants": lambda x: np.minimum(1.0, x) + np.minimum(x * x, np.arange(12.0).reshape(2, 6)),
    "square": lambda x: np.square(x) - np.negative(x),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_rule_against_complex_step(name):
    formula = FORMULAS[name]
    result = formula(independent(X))
    assert isinstance(result, Dual)
    expected = formula(X)
    assert result.shape == expected.shape and result.ndim == expected.ndim
    assert result.value == pytest.approx(expected, rel=EXACT, abs=EXACT)
    for i in range(len(X)):
        exact = formula(X + 1j * H * np.eye(len(X))[i]).imag / H
        assert result.derivative[i] == pytest.approx(exact, rel=EXACT, abs=EXACT)


@pytest.mark.parametrize("name", FORMULAS)
def test_recorded_at_one_point_and_done_again_at_another(name):
    """The same digits as of the formula itself, and as before on coming back."""
    formula, tape, moved = FORMULAS[name], Tape(), X[::-1] + 0.3
    x = independent(X, tape)
    result = formula(x)
    first = result.block.copy()
    for values, expected in ((moved, formula(independent(moved)).block), (X, first)):
        x.value[...] = values
        tape.run()
        assert np.array_equal(result.block, expected)
    assert not np.array_equal(first, formula(independent(moved)).block)


def test_a_recorded_number_is_not_given_away():
    """It would stay what it was at the first point."""
    with pytest.raises(TypeError, match="recorded"):
        float(independent(X, Tape())[0])


def test_known_functions():
    x = independent(X)
    squared = elementwise(x, X**2, 2.0 * X)
    assert np.array_equal(squared.derivative, np.diag(2.0 * X))
    summed = chain(np.array([X.sum()]), np.ones((1, 6)), x)
    assert np.array_equal(summed.derivative, np.ones((6, 1)))


@pytest.mark.parametrize(
    "formula", [lambda x: np.arctan(x), lambda x: np.cumsum(x), lambda x: x @ x, lambda x: np.add.reduce(x)]
)
def test_unknown_operations_are_refused(formula):
    """An operation without a rule must not return a value without its derivatives."""
    with pytest.raises(TypeError):
        formula(independent(X))


def test_length_and_float():
    x = independent(X)
    assert len(x) == 6
    assert float(x[1]) == X[1]
