"""What a node knows the variables of a design by, and the product that carries derivatives from there to all of them.

A formula at a node depends on the P variables through a few numbers of that node. Differentiated by those few, its
derivatives are short; one product with the table of theirs, for all nodes in one call, makes them derivatives with
respect to all P. Derivatives stand last in a table, so that no product has to put them into another order first.
"""

from collections.abc import Sequence
from typing import TypeVar

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.tape import Tape, written


class NodeTable:
    """Some numbers of each of n nodes, with their derivatives.

    Args:
        nodes: n.
        rows: how many numbers of a node.
        variables: P.
        tape: where what is done to it is recorded.

    Attributes:
        block: (n, rows, 1 + P) each value, followed by its derivatives.
        tape: as given.
    """

    def __init__(self, nodes: int, rows: int, variables: int, tape: Tape | None) -> None:
        self.block, self.tape = np.zeros((nodes, rows, 1 + variables)), tape

    def row(self, which: int) -> Dual:
        """(n,) one of the numbers."""
        return Dual(self.block[:, which].T, self.tape)

    def rows(self, which: slice) -> Dual:
        """(rows, n) some of them."""
        return Dual(self.block[:, which].transpose(2, 1, 0), self.tape)

    def by_node(self, which: slice) -> Dual:
        """(n, rows) some of them."""
        return Dual(self.block[:, which].transpose(2, 0, 1), self.tape)

    def local(self, which: slice) -> Dual:
        """(rows, n) some of them, differentiated by themselves alone."""
        source = self.block[:, which, 0].T
        block = np.zeros((1 + len(source), *source.shape))
        block[1:] = np.eye(len(source))[:, :, None]
        written(self.tape, np.copyto, block[0], source)
        return Dual(block, self.tape)

    def put(self, which: int, values: Dual) -> None:
        """Values (n,), or () of all nodes, into a row."""
        written(self.tape, np.copyto, self.block[:, which], values.block.T)

    def take(self, which: slice, local: Sequence[Dual], table: "NodeTable", variables: slice) -> None:
        """Carry: put into some rows what is known by its derivatives with respect to rows of a table.

        Args:
            which: of these rows.
            local: (rows, n) each, what shall be in them, one behind the other.
            table: of the nodes.
            variables: which of its rows ``local`` is differentiated by.
        """
        blocks = [rows.block for rows in local]
        by_node = np.empty((len(self.block), sum(block.shape[1] for block in blocks), len(blocks[0])))
        written(self.tape, np.concatenate, blocks, 1, by_node.transpose(2, 1, 0))
        self.carry(which, by_node, table, variables)

    def carry(self, which: slice, by_node: FloatArray, table: "NodeTable", variables: slice) -> None:
        """As `take`, of (n, rows, 1 + V) values and derivatives node by node."""
        values, derivatives = self.block[:, which, 0], self.block[:, which, 1:]
        written(self.tape, np.copyto, values, by_node[:, :, 0])
        written(self.tape, np.matmul, by_node[:, :, 1:], table.block[:, variables, 1:], derivatives)


Told = TypeVar("Told")


def told(one: Told, **known: object) -> Told:
    """An object whose cached properties are known already: it finds them where it would keep them itself."""
    vars(one).update(known)
    return one
