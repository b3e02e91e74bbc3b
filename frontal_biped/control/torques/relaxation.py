"""The nearest program that has a solution: what gives way where no torques keep every limit, in which order, how far.

Motors never: no command can overstep their limits, and with them alone there is always a solution, u = 0. Of the other
rows each gets a slack s, penalised by its square; the least overstepping

    minimise    1/2 |s_contact|^2 + 1/2 w_j |s_joints|^2 + w_t (the cost of the walking program)
    subject to  its dynamics and torque limits as they are,   l <= C x + s <= u   for the other rows,

with rows in the units of the program (the weight, the weight on 0.1 m, 10 rad/s^2). w_j < 1: a robot saves first its
footing, then its joints. w_t only makes the answer unique: last comes the gait. Then the walking program itself is
solved, its limits moved by s. Both torques and overstepping are continuous where a program begins to have no solution,
as s is zero there; torques that jump would make a robot chatter along that border.

The same problem in two shapes: as a least distance in the residuals of the targets (`Overstepping`, to rounding),
and as a quadratic program for ProxQP (`relaxed`, `widened`). Weights, order and room are those below in both.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.linearisation import JOINTS
from frontal_biped.control.torques.walking_qp import Rows
from frontal_biped.numerics.least_distance import nearest_point_of
from frontal_biped.numerics.quadratic_program import QuadraticProgram

CONTACT_WEIGHT = 1.0
JOINT_WEIGHT = 1e-2
"""w_j: the joints' slacks weigh as much as the contact's when they are ten times as large."""

TASK_WEIGHT = 1e-9
"""w_t: so small that the overstepping found is the least there is, to more digits than any use of it has."""

SLACK = 1e-6
"""More room than is needed, in units of the largest slack or 1: for the tolerance of the slacks."""


def weights(rows: Rows) -> FloatArray:
    """(k,) weight of every inequality of the walking program; inf: it never gives way.

    The condition of a control Lyapunov function is among those that do not: it has a relaxation of its own.
    """
    weight = np.full(rows.decrease.stop, np.inf)
    weight[rows.contact], weight[rows.joint] = CONTACT_WEIGHT, JOINT_WEIGHT
    return weight


class Overstepping:
    """The least overstepping of limits rows'(r, 1) >= 0, to rounding; the cost of the task is |r|^2 / 2, r (4,).

    Args:
        weight: (k,) of the rows; inf: it never gives way.
    """

    def __init__(self, weight: FloatArray) -> None:
        soft = np.flatnonzero(np.isfinite(weight))
        self._weight, self._gives_way = weight, np.isfinite(weight).astype(float)
        self._rows = np.zeros((JOINTS + len(soft) + 1, len(weight)))  # h goes below
        self._rows[JOINTS + np.arange(len(soft)), soft] = weight[soft] ** -0.5

    def least(self, limits: FloatArray, unit: float) -> FloatArray:
        """(k,) by how much the rows give way, a little more than they must.

        Args:
            limits: (5, k).
            unit: size of r in which the cost is measured [-], as the walking program's is in units of its own size.

        Raises:
            NoFeasiblePointError: rounding makes it look as if motors had to give way too.
        """
        rows = self._rows.copy()
        np.multiply(limits[:JOINTS], unit / TASK_WEIGHT**0.5, out=rows[:JOINTS])
        rows[-1] = limits[JOINTS]
        s = nearest_point_of(rows)
        s /= self._weight
        s += _room(s) * self._gives_way
        return s


def relaxed(original: QuadraticProgram, weight: FloatArray) -> QuadraticProgram:
    """The program of the least overstepping: in the walking program's variables and a slack of each row that gives way.

    Args:
        original: the walking program.
        weight: (k,) of its rows.
    """
    soft, n = np.flatnonzero(np.isfinite(weight)), len(original.g)
    size = n + len(soft)
    H, g = np.zeros((size, size)), np.zeros(size)
    H[:n, :n], g[:n] = TASK_WEIGHT * original.H, TASK_WEIGHT * original.g
    H[n:, n:] = np.diag(weight[soft])
    A, C = np.zeros((len(original.A), size)), np.zeros((len(original.C), size))
    A[:, :n], C[:, :n] = original.A, original.C
    C[soft, n + np.arange(len(soft))] = 1.0
    return original._replace(H=H, g=g, A=A, C=C)


def widened(original: QuadraticProgram, weight: FloatArray, x: FloatArray) -> QuadraticProgram:
    """The walking program with its limits moved as far as a solution x of `relaxed` says."""
    soft, s = np.flatnonzero(np.isfinite(weight)), x[len(original.g) :]
    l, u, room = original.l.copy(), original.u.copy(), _room(np.abs(s))
    l[soft] -= np.maximum(s, 0.0) + room
    u[soft] += np.maximum(-s, 0.0) + room
    return original._replace(l=l, u=u)


def violation(program: QuadraticProgram, x: FloatArray) -> float:
    """Largest amount by which x (n,), slacks behind it or not, oversteps the inequalities, in the program's units."""
    value = program.C @ x[: len(program.g)]
    return float(max(np.max(program.l - value), np.max(value - program.u), 0.0))


def _room(s: FloatArray) -> float:
    return SLACK * max(1.0, *s.tolist())
