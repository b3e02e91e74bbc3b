"""Tables of nodes: derivatives carried by one product against the same formulas differentiated by all variables."""

import numpy as np
import pytest
from random_states import assert_close

from frontal_biped.design.forward_mode import Dual, independent
from frontal_biped.design.node_table import NodeTable, told
from frontal_biped.design.tape import Tape
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics, RestrictedDynamics

NODES, VARIABLES = 5, 7
SAME = 1e-13
"""Relative difference of the same sums in another order."""

X = np.random.default_rng(0).uniform(0.5, 1.5, VARIABLES)


def filled(x, tape=None):
    """A table of three rows, each a product of the variables with a matrix, and the same rows for themselves."""
    table = NodeTable(NODES, 3, VARIABLES, tape)
    rows = [np.random.default_rng(row).uniform(0.5, 1.5, (NODES, VARIABLES)) @ x for row in range(3)]
    for which, row in enumerate(rows):
        table.put(which, row)
    return table, rows


def formula(a, b):
    """Two rows of what a node knows."""
    return np.stack([np.sqrt(a) / b, a * b + np.exp(-a)])


def test_rows_are_what_was_put():
    table, rows = filled(independent(X))
    for which, row in enumerate(rows):
        assert np.array_equal(table.row(which).block, row.block)
    assert np.array_equal(table.rows(slice(1, 3)).block, np.stack(rows[1:]).block)
    assert np.array_equal(table.by_node(slice(1, 3)).block, np.stack(rows[1:]).block.swapaxes(1, 2))


def test_one_number_of_all_nodes():
    table, _ = filled(independent(X))
    table.put(0, independent(X)[2])
    assert np.array_equal(table.row(0).value, np.full(NODES, X[2]))
    assert np.array_equal(table.row(0).derivative[2], np.ones(NODES))


def test_carried_is_differentiated_by_all():
    table, rows = filled(independent(X))
    found = NodeTable(NODES, 4, VARIABLES, None)
    found.take(slice(1, 3), [formula(*table.local(slice(1, 3)))], table, slice(1, 3))
    expected = formula(*rows[1:])
    assert_close(found.rows(slice(1, 3)).block, expected.block, SAME)
    assert not np.any(found.block[:, [0, 3]])


def test_done_again_at_another_point():
    tape = Tape()
    x = independent(X, tape)
    table, _ = filled(x, tape)
    found = NodeTable(NODES, 2, VARIABLES, tape)
    found.take(slice(0, 2), list(formula(*table.local(slice(0, 2)))[:, None]), table, slice(0, 2))
    x.value[...] = X[::-1]
    tape.run()
    expected = formula(*filled(independent(X[::-1]))[1][:2])
    assert_close(found.rows(slice(0, 2)).block, expected.block, SAME)


def test_told_is_not_computed():
    rows = np.ones((3, NODES))
    of = RestrictedDynamics(ProjectedDynamics(rows, rows, rows), np.zeros(NODES), np.zeros(NODES))
    known = told(of, I_P=np.full(NODES, 2.0))
    assert np.array_equal(known.I_P, np.full(NODES, 2.0))
    assert known.drive == pytest.approx(known.kappa_2 * 2.0)


def test_local_derivatives_are_those_of_the_rows_alone():
    table, _ = filled(independent(X))
    local = table.local(slice(0, 2))
    assert isinstance(local, Dual) and local.shape == (2, NODES)
    assert np.array_equal(local.derivative, np.repeat(np.eye(2)[:, :, None], NODES, axis=2))
