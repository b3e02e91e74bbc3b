"""Limits as rows: of the forces and accelerations of a motion, and so of the residuals that these are affine in.

A limit is a row of the forces (F_h, F_v, N_0, u) and accelerations that must not be less than a bound. Of a motion that
is affine in its residuals, a matrix by (r, 1), it becomes a column g over a room: g'r + room >= 0, the room being what
the limit has at r = 0. In these coordinates a tick's limits are one product of matrices.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limits import JointLimits
from frontal_biped.control.torques.linearisation import JOINTS, N_0
from frontal_biped.control.torques.nearest_residuals import ROOM
from frontal_biped.control.torques.relaxation import weights
from frontal_biped.control.torques.walking_qp import ANKLE, FORCE, FORCES, OUTPUT_ACCELERATION, VARIABLES, U, WalkingQp
from frontal_biped.model.biped import BASE
from frontal_biped.model.state import State
from frontal_biped.numerics.quadratic_program import UNBOUNDED

AMPLE = 1e9
"""Stands for infinite room: a row that is never active."""


class LimitRows:
    """Rows of all limits of a walking program, in its units.

    Args:
        qp: the program.

    Attributes:
        joints: limits of the joints' motion, or None.
        of_forces: (k, 7) rows of the forces.
        of_ddq: (k, 4) of the accelerations.
        fixed: lower bounds of those of them that are the same at every tick; the joints' come behind.
        weight: (k,) of their overstepping; inf: they never give way.
    """

    def __init__(self, qp: WalkingQp) -> None:
        self.joints = qp.limits.joints
        forces, self.fixed, weight = _rows_of_forces(qp)
        limited = np.zeros(0, np.intp) if self.joints is None else self.joints.limited
        joint = np.eye(JOINTS)[limited] / OUTPUT_ACCELERATION
        self.of_forces = np.concatenate([forces, np.zeros((2 * len(joint), BASE + JOINTS))])
        self.of_ddq = np.concatenate([np.zeros((len(forces), JOINTS)), joint, -joint])
        of_joints = weights(qp.rows)[qp.rows.joint][limited]
        self.weight = np.concatenate([weight, of_joints, of_joints])
        self._fixed, self._limited = self.fixed.tolist(), limited.tolist()
        # of the forces, and of the accelerations behind them where any row is of these
        rows = self.of_forces if self.joints is None else np.hstack([self.of_forces, self.of_ddq])
        self._columns = np.ascontiguousarray(rows.T)

    def at(self, state: State, motion: FloatArray, forces: FloatArray) -> FloatArray:
        """(5, k) all limits, rows'(r, 1) >= 0, at a state, from accelerations (4, 5) and forces (7, 5) by (r, 1)."""
        if self.joints is None:
            rows, least = forces.T.dot(self._columns), self.fixed
        else:
            rows, least = np.concatenate([forces, motion]).T.dot(self._columns), self._least(self.joints, state)
        room = rows[ROOM]
        room -= least
        return rows

    def _least(self, joints: JointLimits, state: State) -> FloatArray:
        """(k,) lower bounds of the rows at a state."""
        bounds = joints.bounds_of_joints(state)
        least = [*self._fixed]
        least += [max(bounds[i][0] / OUTPUT_ACCELERATION, -AMPLE) for i in self._limited]
        least += [max(bounds[i][1] / -OUTPUT_ACCELERATION, -AMPLE) for i in self._limited]
        return np.fromiter(least, float, len(least))


def _rows_of_forces(qp: WalkingQp) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows (k, 7) of the limits of contact and motors by the forces, their least values (k,), their weights (k,).

    The program has no N_0 among its variables. Its rows of the contact have it as the combination that it is of
    others, and nothing else of the torques, so that the ankle's tells how much of it they have.
    """
    contact, torque, *_ = qp.rows
    program, fixed = qp.fixed, slice(contact.start, torque.stop)
    C, l, u = program.C[fixed, :VARIABLES].copy(), program.l[fixed].copy(), program.u[fixed].copy()
    moment = np.zeros(len(C))
    moment[contact] = C[contact, ANKLE]
    C -= np.outer(moment, qp.moment)
    l += moment * qp.moment_constant
    C /= qp.scale
    rows = np.zeros((len(C), BASE + JOINTS))
    rows[:, :FORCES], rows[:, N_0], rows[:, BASE:] = C[:, FORCE], moment / qp.torque_unit, C[:, U]
    below, above, weight = l > -UNBOUNDED, u < UNBOUNDED, weights(qp.rows)[fixed]
    return (
        np.concatenate([rows[below], -rows[above]]),
        np.concatenate([l[below], -u[above]]),
        np.concatenate([weight[below], weight[above]]),
    )
