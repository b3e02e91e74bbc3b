"""Motions in the residuals of the rows: the one that meets them all, and how it changes as some are missed.

The joints outside the legs have a row each that gives their acceleration; what is left are 24 rows for 24 unknowns,
base, legs and wrench, factorised once a tick.
"""

from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.tasks import LEGS, NATURE, WRENCH, Rows, TaskRows
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance

CORE = NATURE + LEGS
"""Rows, and unknowns, when the joints outside the legs are given."""


class Motion(NamedTuple):
    """Accelerations, wrench and torques; or columns of them.

    Attributes:
        x: (nv + 6,) accelerations of base and joints, then the wrench of the stance sole.
        tau: (n,) joint torques [N m].
    """

    x: FloatArray
    tau: FloatArray


class SingularRowsError(SimulationError):
    """The rows of a tick contradict each other: a straight knee, a foot in the air."""


class MotionSolver:
    """Solves the rows of a tick.

    Args:
        rows: what writes them.
        worth: (12 + outside,) weight of each asked-for row (`tasks.weights`).
        standing: weight of the six rows of the standing foot, where they may be missed.
    """

    def __init__(self, rows: TaskRows, worth: FloatArray, standing: float) -> None:
        self._nv = nv = BASE + len(rows.free.joint_names)
        size, outside = nv + WRENCH, BASE + rows.outside
        self._outside, self._core = outside, np.setdiff1d(np.arange(size), outside)
        self._K = np.zeros((CORE, CORE))
        count = len(outside)
        self._missed = 1.0 / np.concatenate([worth, np.full(WRENCH, standing)])
        self._columns = np.zeros((CORE, LEGS + count + WRENCH))
        self._columns[NATURE:, :LEGS] = np.diag(self._missed[:LEGS])
        self._columns[BASE:NATURE, LEGS + count :] = np.diag(self._missed[LEGS + count :])
        self._along = np.zeros((size, LEGS + count + WRENCH))
        self._along[outside, LEGS + np.arange(count)] = self._missed[LEGS : LEGS + count]
        self._of_outside = slice(LEGS, LEGS + count)

    def factorise(self, rows: Rows, state: SpaceState, stance: Stance) -> None:
        """Take the rows of a tick.

        Raises:
            SingularRowsError: they have no single solution.
        """
        self._rows = rows
        self._M, self._h = state.M[BASE:], state.bias[BASE:]
        self._J = state.feet[stance].J[:, BASE:]
        np.take(rows.A[:CORE], self._core, axis=1, out=self._K, mode="clip")
        self._lu, self._pivots, singular = dgetrf(self._K)
        if singular:
            raise SingularRowsError("the rows of the whole body contradict each other")

    def meeting_all(self) -> Motion:
        """The motion that meets every row."""
        A, b = self._rows
        x = np.empty(self._nv + WRENCH)
        given = b[CORE:]
        x[self._outside] = given
        x[self._core], _ = dgetrs(self._lu, self._pivots, b[:CORE] - A[:CORE, self._outside] @ given)
        return Motion(x, self._M @ x[: self._nv] + self._h - x[self._nv :] @ self._J)

    def missing(self) -> Motion:
        """Columns: by how much the motion changes as a row is missed by one over its weight.

        First the asked-for rows, then those of the standing foot.
        """
        columns, of = self._columns, self._of_outside
        np.multiply(self._rows.A[:CORE, self._outside], -self._missed[of], out=columns[:, of])
        along = self._along
        along[self._core], _ = dgetrs(self._lu, self._pivots, columns)
        return Motion(along, self._M @ along[: self._nv] - self._J.T @ along[self._nv :])
