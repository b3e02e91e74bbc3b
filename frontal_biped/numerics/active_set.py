"""Strictly convex quadratic programs with many inequalities and few active ones, exactly and reproducibly.

    minimise 1/2 x'H x + g'x   subject to   C x >= c

by the dual active-set method of Goldfarb and Idnani (1983): from the minimum under the constraints that are expected
to be active, the one farthest away is added until none is, and those that no longer push are dropped. The work follows
the changes of the active set, not the number of constraints. Unlike an interior or proximal method there is no
tolerance on the answer: it solves the linear system of its active constraints, and equal input gives equal digits.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

from frontal_biped.arrays import FloatArray
from frontal_biped.numerics.least_distance import NoFeasiblePointError, nearest_point

SWEEPS = 20
"""Changes of the active set per variable at which the method is given up: rounding; it needs one or two."""

VIOLATED = 1e-11
"""Violation that is not rounding, relative to the bound where that is above one."""

SINGLE_THREAD = 100_000
"""Multiplications below which BLAS keeps to one thread; OpenBLAS shares a product out from 262144 on."""

TINY = float(np.finfo(float).tiny)

DEPENDENT = 1e-14
"""Squared share of a normal that is not a sum of the active ones, below which it is rounding."""


class ActiveSetAnswer(NamedTuple):
    """Answer.

    Attributes:
        x: (n,) minimiser.
        multipliers: (k,) of C x >= c, not negative.
        active: which constraints are met exactly.
    """

    x: FloatArray
    multipliers: FloatArray
    active: tuple[int, ...]


class IndefiniteError(ArithmeticError):
    """H is not positive definite."""


class ConvexProgram:
    """Programs that differ in their bounds c alone: what the matrices want is done once.

    With the Cholesky factor H = L L' and y = L'x + L^-1 g this is the point of a polyhedron nearest to the origin; its
    faces have the normals L^-1 C'.

    Args:
        H: (n, n) symmetric positive definite.
        g: (n,).
        C: (k, n).

    Raises:
        IndefiniteError: H is not positive definite.
    """

    def __init__(self, H: FloatArray, g: FloatArray, C: FloatArray) -> None:
        try:
            L = np.linalg.cholesky(H)
        except np.linalg.LinAlgError as error:
            raise IndefiniteError("H is not positive definite") from error
        self._C, self._inverse = C, np.linalg.inv(L)
        self._lowest = -self._inverse.T @ (self._inverse @ g)
        self._room = C @ self._lowest
        self._lengths = np.full(len(C), np.nan)

    def _steepness(self, rows: NDArray[np.intp]) -> FloatArray:
        """(a,) by how much the value of a constraint grows per unit of y, the lengths of the normals.

        Args:
            rows: (a,) which constraints; few are ever violated, and the others are not asked about.
        """
        unknown = rows[np.isnan(self._lengths[rows])]
        if len(unknown):
            squares = _product(self._inverse, self._C[unknown].T)
            squares *= squares
            self._lengths[unknown] = np.sqrt(np.maximum(squares.sum(axis=0), TINY))
        return self._lengths[rows]

    def solve(self, c: FloatArray, expected: Sequence[int] = ()) -> ActiveSetAnswer:
        """Solve for one set of bounds.

        Where H is so ill-conditioned that rounding has the better of the method (its eigenvalues span ten powers of
        ten, and nearly as many constraints are active as there are variables) the dual is solved as a non-negative
        least-squares problem (`least_distance`): slower, for it begins from nothing, and it squares no condition.

        Args:
            c: (k,).
            expected: constraints that may be active, as in a similar program; no answer depends on them.

        Raises:
            NoFeasiblePointError: no x satisfies C x >= c, or rounding does not let tell.
        """
        try:
            return self._by_active_set(c, expected)
        except NoFeasiblePointError:
            multipliers = nearest_point(_product(self._inverse, self._C.T), c - self._room)
        active = np.flatnonzero(multipliers)
        x = self._lowest + self._inverse.T @ (self._inverse @ (self._C[active].T @ multipliers[active]))
        return ActiveSetAnswer(x, multipliers, tuple(active.tolist()))

    def _by_active_set(self, c: FloatArray, expected: Sequence[int]) -> ActiveSetAnswer:
        edge, missing, expected = c - VIOLATED * np.maximum(1.0, np.abs(c)), c - self._room, list(expected)
        faces = _Faces(self._inverse @ self._C[expected].T, missing[expected], expected)
        for _ in range(SWEEPS * self._C.shape[1] + 1):
            beyond = self._C @ self._place(faces) - edge
            beyond[faces.rows] = 0.0
            violated = np.flatnonzero(beyond < 0.0)
            if not len(violated):
                faces.polish()
                multipliers = np.zeros(len(c))
                multipliers[faces.rows] = faces.multipliers
                return ActiveSetAnswer(self._place(faces), multipliers, tuple(faces.rows))
            farthest = int(violated[np.argmin(beyond[violated] / self._steepness(violated))])
            faces.add(farthest, self._inverse @ self._C[farthest], float(missing[farthest]))
        raise NoFeasiblePointError("the active-set method did not end")

    def _place(self, faces: "_Faces") -> FloatArray:
        """x (n,) of a point y."""
        return self._lowest + self._inverse.T @ faces.point


class _Faces:
    """The active constraints N'y = h, and the point y = N multipliers nearest to the origin on all of them.

    Args:
        normals: (n, a) N of the constraints expected.
        offsets: (a,) h.
        rows: which they are. Those that would have to pull are left out, and all where they depend on each other.
    """

    def __init__(self, normals: FloatArray, offsets: FloatArray, rows: Sequence[int]) -> None:
        self.rows, self._N, self._h = list(rows), normals, offsets
        self._gram = normals.T @ normals
        self.multipliers, dependent = self._solved(offsets)
        while dependent or np.min(self.multipliers, initial=0.0) < 0.0:
            self._keep(np.flatnonzero(~(dependent | (self.multipliers < 0.0))))
            self.multipliers, dependent = self._solved(self._h)

    @property
    def point(self) -> FloatArray:
        """y (n,)."""
        return self._N @ self.multipliers

    def add(self, row: int, normal: FloatArray, offset: float) -> None:
        """Move to where one more constraint, violated so far, is met; those that stop to push on the way are dropped.

        Raises:
            NoFeasiblePointError: it is opposed to the active ones.
        """
        push, size = 0.0, normal.dot(normal)
        missing = offset - normal.dot(self.point)
        along = normal.dot(self._N)
        while True:
            yields, _ = self._solved(along)  # what the others push less, per unit of the new one
            across = normal - self._N.dot(yields)
            free = across.dot(across)
            full = missing / free if free > DEPENDENT * size else np.inf
            until = np.where(yields > 0.0, self.multipliers, np.inf) / np.maximum(yields, TINY)
            first = int(until.argmin()) if len(until) else -1
            step = min(full, until[first]) if len(until) else full
            if step == np.inf:
                raise NoFeasiblePointError("the inequalities contradict each other")
            push += step
            self.multipliers = np.maximum(self.multipliers - step * yields, 0.0)
            if step == full:
                break
            missing -= step * free
            kept = np.flatnonzero(np.arange(len(until)) != first)
            self._keep(kept)
            along = along[kept]
        a = len(self.rows)
        gram = np.empty((a + 1, a + 1))
        gram[:a, :a], gram[a, :a], gram[:a, a], gram[a, a] = self._gram, along, along, size
        self.rows.append(row)
        self._gram, self._N = gram, np.concatenate([self._N, normal[:, None]], axis=1)
        self._h = np.concatenate([self._h, [offset]])
        self.multipliers = np.concatenate([self.multipliers, [push]])

    def polish(self) -> None:
        """Multipliers without what rounding has added up."""
        exact, dependent = self._solved(self._h)
        if not dependent and np.min(exact, initial=0.0) >= 0.0:
            self.multipliers = exact

    def _keep(self, which: NDArray[np.intp]) -> None:
        self.rows = [self.rows[i] for i in which]
        self._N, self._gram = self._N[:, which], self._gram[which[:, None], which]
        self._h, self.multipliers = self._h[which], self.multipliers[which]

    def _solved(self, right: FloatArray) -> tuple[FloatArray, bool]:
        """(N'N)^-1 right (a,), and whether the constraints depend on each other."""
        if not self.rows:
            return np.zeros(0), False
        *_, solution, info = dposv(self._gram, right)
        return solution, info != 0


def _product(A: FloatArray, B: FloatArray) -> FloatArray:
    """A @ B in pieces too small for BLAS to share out among threads: the digits must not depend on their number."""
    size = max(1, SINGLE_THREAD // max(A.size, 1))
    pieces = [A @ B[:, begin : begin + size] for begin in range(0, B.shape[1], size)]
    return np.concatenate(pieces, axis=1) if pieces else np.zeros((len(A), 0))
