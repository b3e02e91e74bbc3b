"""The nearest program that has a solution: limits give way in an order, motors never.

Every row of the contact and of the joints gets a slack s, penalised by its square,

    minimise    the cost of the walking program + 1/2 sum_i w_i s_i^2
    subject to  its dynamics and torque limits as they are,   l <= C x + s <= u   for the other rows,

with rows in the units of the program (weights of the robot, 0.1 m of lever, 10 rad/s^2) and w large for the contact,
smaller for the joints, and 1 for the outputs: a robot first saves its footing, then its joints, then its gait. The
motors' limits stay, for no command can overstep them, and with them alone there is always a solution: u = 0.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.walking_qp import CONTACT, JOINT, VARIABLES
from frontal_biped.quadratic_program import QuadraticProgram

CONTACT_PENALTY = 1e6
JOINT_PENALTY = 1e3


class RelaxedQp:
    """Builds the relaxed program; its matrices are allocated once and overwritten at every call.

    Args:
        original: the program relaxed; only its shape is used.
    """

    def __init__(self, original: QuadraticProgram) -> None:
        n, rows = len(original.g), len(original.l)
        penalty = np.zeros(rows)
        penalty[CONTACT], penalty[JOINT] = CONTACT_PENALTY, JOINT_PENALTY
        soft = np.flatnonzero(penalty)
        size = n + len(soft)
        H, A, C = np.zeros((size, size)), np.zeros((len(original.b), size)), np.zeros((rows, size))
        # slacks in the unit in which their penalty is 1
        H[n:, n:] = np.eye(len(soft))
        C[soft, n + np.arange(len(soft))] = 1.0 / np.sqrt(penalty[soft])
        self._n = n
        self.program = QuadraticProgram(H, np.zeros(size), A, original.b, C, original.l, original.u)

    def build(self, original: QuadraticProgram) -> QuadraticProgram:
        """The program of a walking program just built; the first variables of its solution are those of the other."""
        n, program = self._n, self.program
        program.H[:n, :n], program.g[:n] = original.H, original.g
        program.A[:, :n], program.C[:, :n] = original.A, original.C
        return program._replace(b=original.b, l=original.l, u=original.u)


def violation(program: QuadraticProgram, x: FloatArray) -> float:
    """Largest amount by which x (10,) oversteps the inequalities, in the units of the program."""
    value = program.C @ x[: program.C.shape[1]]
    return float(max(np.max(program.l - value), np.max(value - program.u), 0.0))
