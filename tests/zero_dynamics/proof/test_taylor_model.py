"""Balls of functions against the functions: values, slopes, integrals, rounding, and what is cut off."""

import numpy as np
import pytest

from frontal_biped.zero_dynamics.proof import taylor_model
from frontal_biped.zero_dynamics.proof.balls import arb, working
from frontal_biped.zero_dynamics.proof.taylor_model import TaylorModel

LOW, HIGH = np.array([0.0, 0.5]), np.array([0.5, 0.75])
"""Two panels."""

CENTRE, REACH = arb("0.7"), arb("0.2")
"""Of the parameter."""


@pytest.fixture(autouse=True)
def _working():
    with working():
        yield


@pytest.fixture(params=[(10, 14), (3, 2), (0, 4)])
def orders(request, monkeypatch):
    """Where little is kept nearly everything is in the radius."""
    monkeypatch.setattr(taylor_model, "ORDERS", request.param)
    return request.param


def variables():
    return TaylorModel.along(LOW, HIGH), TaylorModel.parameter(CENTRE, REACH)


def evaluated(model, panel, t, y):
    """A ball of a model's values at a point."""
    total = arb(0)
    for i, row in enumerate(model.terms[min(panel, len(model.terms) - 1)]):
        for j, c in enumerate(row):
            total += arb(float(c)) * arb(t) ** i * arb(y) ** j
    return total + arb(0, float(model.radius[min(panel, len(model.radius) - 1)]))


def points(seed, count=20):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        panel, t, y = int(rng.integers(2)), *rng.uniform(-1.0, 1.0, 2)
        s = (arb(LOW[panel]) + arb(HIGH[panel])) / 2 + arb(t) * (arb(HIGH[panel]) - arb(LOW[panel])) / 2
        yield panel, t, y, s, CENTRE + arb(y) * REACH


FORMULAS = {
    "polynomial": lambda s, x: (s * s * 3 - x) * (x * x * x + s) - 2 * s * x,
    "with balls": lambda s, x: arb("0.1") * s * x - arb("1.3") + arb(2) / 3 * x,
    "quotient": lambda s, x: (s + x) / (x * 2 + s * s + 1),
    "by a number": lambda s, x: (s - x) / 7 + 1 / (x + 1),
    "long": lambda s, x: s * s * s * s * s * s * x * x * x * x * x * x * x * x * x,
}


@pytest.mark.parametrize("name", FORMULAS)
def test_arithmetic(name, orders):
    formula = FORMULAS[name]
    model = formula(*variables())
    for panel, t, y, s, x in points(0):
        assert evaluated(model, panel, t, y).contains(formula(s, x))


@pytest.mark.parametrize("function", ["sin", "cos", "exp"])
def test_power_series(function, orders):
    s, x = variables()
    argument = s * x + 2 * x
    sin, cos = argument.sin_cos()
    model = {"sin": sin, "cos": cos, "exp": argument.exp()}[function]
    for panel, t, y, s, x in points(1):
        assert evaluated(model, panel, t, y).contains(getattr(s * x + 2 * x, function)())


def test_what_is_kept_is_nearly_all():
    s, x = variables()
    model = (s * x).exp() / (x + s + 1)
    assert np.all(model.radius < 1e-8)


def test_what_is_cut_off_counts(monkeypatch):
    """Without its radius a model of few terms is wrong."""
    monkeypatch.setattr(taylor_model, "ORDERS", (1, 1))
    s, x = variables()
    model = TaylorModel((s * x).exp().terms, np.zeros(2))
    assert not all(evaluated(model, panel, t, y).contains((s * x).exp()) for panel, t, y, s, x in points(2))


def test_rounding_counts():
    _, x = variables()
    model = (x + 1e17) - 1e17
    assert model.terms.max() == 0.0 or abs(model.terms[0, 0, 0] - 0.7) > 1e-3
    assert evaluated(model, 0, 0.0, 0.3).contains(CENTRE + arb("0.3") * REACH)
    assert model.radius[0] < 100.0


def test_the_inverse_of_what_may_vanish_is_not_known():
    s, _ = variables()
    with np.errstate(all="ignore"):
        inverse = (s - 0.25).inverse
    assert np.isinf(inverse.radius[0])  # on [0, 0.5]
    assert inverse.radius[1] < np.inf  # on [0.5, 0.75]


def test_a_complex_zero_counts():
    """1 + 4 y^2 is positive, but its Taylor series about 0 does not converge at |y| = 1."""
    y = TaylorModel.parameter(arb(0), arb(1))
    with np.errstate(all="ignore"):
        assert np.isinf((1 + 4 * y * y).inverse.radius[0])


def test_positive_on_the_whole_disc():
    s, x = variables()
    assert np.all(x.surely_positive)
    assert list((s - 0.5).surely_positive) == [False, False]
    assert list((s - 0.49).surely_positive) == [False, True]


def test_integrals(orders):
    """int s^2 x ds, panel by panel, from the first on."""
    s, x = variables()
    inner = s * s * x
    half_widths = TaylorModel((0.5 * (HIGH - LOW))[:, None, None], np.zeros(2))
    F = (inner * half_widths).antiderivative()
    parts = F.at(1) - F.at(-1)
    before, total = parts.before(), parts.total()
    for _, _, y, _, x in points(3):
        thirds = [arb(end) ** 3 / 3 * x for end in (0.5, 0.75)]
        assert evaluated(before, 0, 0.0, y).contains(0)
        assert evaluated(before, 1, 0.0, y).contains(thirds[0])
        assert evaluated(total, 0, 0.0, y).contains(thirds[1])
        assert total.value(arb(y)).contains(thirds[1])


@pytest.mark.parametrize("kept", [14, 3])
def test_slopes(kept, monkeypatch):
    monkeypatch.setattr(taylor_model, "ORDERS", (10, kept))
    x = TaylorModel.parameter(CENTRE, REACH)
    model = (1 / (x + 1)).exp()
    for _, _, y, _, _ in points(4):
        y *= 0.9
        at = CENTRE + arb(y) * REACH
        slope = -((1 / (at + 1)).exp()) / ((at + 1) * (at + 1)) * REACH
        assert model.slope(arb(y)).contains(slope)
        assert model.slope(arb(0.9 * y).union(arb(y))).contains(slope)


def test_the_slope_of_the_rest_grows_towards_the_rim():
    """r = radius y^8 has the slope 8 radius y^7, more than its size: that is in the bound."""
    model = TaylorModel(np.zeros((1, 1, 1)), np.array([1e-3]))
    for y in (0.5, 0.8, 0.9):
        assert model.slope(arb(y)).contains(arb("0.001") * 8 * arb(y) ** 7)
        assert model.slope(arb(y)).contains(arb("0.001"))


def test_batches():
    s, x = variables()
    model = s * x
    again = TaylorModel.joined([model.chosen(np.array([1])), model.chosen(np.array([0]))]).chosen(np.array([1, 0]))
    assert np.array_equal(again.terms, model.terms)
    assert np.array_equal(again.radius, model.radius)


@pytest.mark.parametrize("shapes", [((2, 3, 4), (2, 5, 2)), ((1, 1, 6), (3, 4, 1)), ((2, 11, 15), (1, 11, 15))])
def test_products_are_those_of_polynomials(shapes):
    rng = np.random.default_rng(5)
    a, b = (TaylorModel(rng.normal(size=shape), np.zeros(shape[0])) for shape in shapes)
    found = a * b
    for k in range(max(len(a.terms), len(b.terms))):
        x, y = (m.terms[min(k, len(m.terms) - 1)] for m in (a, b))
        whole = np.zeros((x.shape[0] + y.shape[0] - 1, x.shape[1] + y.shape[1] - 1))
        for (i, j), c in np.ndenumerate(x):
            whole[i : i + y.shape[0], j : j + y.shape[1]] += c * y
        kept = whole[: taylor_model.ORDERS[0] + 1, : taylor_model.ORDERS[1] + 1]
        assert found.terms[k] == pytest.approx(kept, abs=1e-12)
        cut = np.abs(whole).sum() - np.abs(kept).sum()
        assert cut <= found.radius[k] <= np.abs(x).sum() * np.abs(y).sum()
