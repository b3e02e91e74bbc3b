"""The nearest program that has a solution: limits give way in an order, motors never.

First the least overstepping: every row of the contact and of the joints gets a slack s, penalised by its square,

    minimise    1/2 |s_contact|^2 + 1/2 w_j |s_joints|^2 + w_t (the cost of the walking program)
    subject to  its dynamics and torque limits as they are,   l <= C x + s <= u   for the other rows,

with rows in the units of the program (the weight, the weight on 0.1 m, 10 rad/s^2) and w_j < 1; w_t only makes the
answer unique. Then the walking program itself, its limits moved by s: a robot saves first its footing, then its joints,
then its gait. Both torques and overstepping are continuous where a program begins to have no solution, as s is zero
there; torques that jump would make a robot chatter along that border. The motors' limits stay, for no command can
overstep them, and with them alone there is always a solution: u = 0.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.walking_qp import Rows
from frontal_biped.numerics.quadratic_program import QuadraticProgram

CONTACT_WEIGHT = 1.0
JOINT_WEIGHT = 1e-2  # w_j
TASK_WEIGHT = 1e-7  # w_t
SLACK = 1e-6  # more room than is needed, for the tolerance of the slacks


class RelaxedQp:
    """Builds the relaxed program; its matrices are allocated once and overwritten at every call.

    Args:
        original: the program relaxed; only its shape is used.
        which: its rows.
    """

    def __init__(self, original: QuadraticProgram, which: Rows) -> None:
        n, rows = len(original.g), len(original.l)
        weight = np.zeros(rows)
        weight[which.contact], weight[which.joint] = CONTACT_WEIGHT, JOINT_WEIGHT
        soft = np.flatnonzero(weight)
        size = n + len(soft)
        H, A, C = np.zeros((size, size)), np.zeros((len(original.b), size)), np.zeros((rows, size))
        H[n:, n:] = np.diag(weight[soft])
        C[soft, n + np.arange(len(soft))] = 1.0
        self._n, self._soft = n, soft
        self.program = QuadraticProgram(H, np.zeros(size), A, original.b, C, original.l, original.u)

    def build(self, original: QuadraticProgram) -> QuadraticProgram:
        """The program of a walking program just built; the first variables of its solution are those of the other."""
        n, program = self._n, self.program
        program.H[:n, :n], program.g[:n] = TASK_WEIGHT * original.H, TASK_WEIGHT * original.g
        program.A[:, :n], program.C[:, :n] = original.A, original.C
        return program._replace(b=original.b, l=original.l, u=original.u)

    def widened(self, original: QuadraticProgram, x: FloatArray) -> QuadraticProgram:
        """The walking program with its limits moved as far as a solution x of `build` says."""
        s = x[self._n :]
        l, u = original.l.copy(), original.u.copy()
        l[self._soft] -= np.maximum(s, 0.0) + SLACK
        u[self._soft] += np.maximum(-s, 0.0) + SLACK
        return original._replace(l=l, u=u)


def violation(program: QuadraticProgram, x: FloatArray) -> float:
    """Largest amount by which x (n,), slacks behind it or not, oversteps the inequalities, in the program's units."""
    value = program.C @ x[: len(program.g)]
    return float(max(np.max(program.l - value), np.max(value - program.u), 0.0))
