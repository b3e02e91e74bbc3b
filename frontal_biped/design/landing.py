"""Where a step lands and what the impact does, with exact derivatives, as rules for `Dual` arrays.

Both are told by equations: the pose by both feet flat on the ground, the velocities behind the impact and the impulse
by rigid contact (`model.impact`). The implicit function theorem differentiates them, and first derivatives of RNEA are
all that it takes from the model: turning joint j moves the lever of joint i <= j as a whole, so dJ_i/dq_j is the
quarter turn of J_j, and by symmetry of second derivatives the later of the two joints counts.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.tape import filled
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.impact import landing_jacobian
from frontal_biped.virtual_constraints.invariance import double_support_pose

SPEEDS = BASE + 4
"""Freedoms of the robot with its stance foot free; the forces on the landing foot are three."""

_TURNING = slice(2, SPEEDS)
"""The freedoms that turn: the stance foot's rotation and the joints."""

_LATER = np.maximum.outer(np.arange(2, SPEEDS), np.arange(BASE, SPEEDS))
"""(5, 4) the later of a freedom that turns and a joint."""

_NO_SPEED = np.zeros(SPEEDS)


class FinalPose(NamedTuple):
    """A pose with both feet flat.

    Attributes:
        q: (4,) [rad].
        J: (3, 7) Jacobian of the swing ankle there: h, v, rotation.
    """

    q: Dual
    J: FloatArray


class DifferentiableLanding:
    """Final pose and impact of a robot; like the robot, not thread-safe.

    Args:
        biped: the robot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        self._biped = biped
        self._weightless = biped.floating.copy()
        self._weightless.gravity.linear = np.zeros(3)
        self._data = self._weightless.createData()
        outer, inner = biped.sole
        self._ends = np.array([[-biped.chain.sole_inner], [biped.chain.sole_outer]])  # of the swing sole, when flat
        self._q = np.zeros(SPEEDS)
        self._matrix, self._right_v = np.zeros((SPEEDS + 3, SPEEDS + 3)), np.zeros((SPEEDS + 3, 4))
        # rows of the landing that are linear in (v+, -L)
        select = np.zeros((9, SPEEDS + 3))
        select[:4, BASE:SPEEDS] = np.eye(4)[::-1]
        select[4:7, SPEEDS:] = -np.eye(3)
        select[6, SPEEDS] = biped.ankle_height
        select[7:, 1] = 1.0
        select[7:, 2] = inner, outer
        self._rows = select

    def pose(self, beta: Dual, step_width: Dual) -> FinalPose:
        """`virtual_constraints.double_support_pose`: the swing ankle stays at (step width, h_a), its foot flat."""
        J = np.empty((3, SPEEDS))

        def fill(block: FloatArray) -> None:
            pose = double_support_pose(self._biped, beta.value.item(), step_width.value.item())
            self._q[BASE:] = block[0] = pose
            J[:] = landing_jacobian(self._biped, self._q)
            # where the stance ankle and the hips take the swing ankle; its own joint turns the foot back
            (h, h_1, h_2, _), (v, v_1, v_2, _), _ = J[:, BASE:].tolist()
            area = h_1 * v_2 - h_2 * v_1
            turns = (h_2 * v - h * v_2) / area, (h * v_1 - h_1 * v) / area
            np.multiply(beta.derivative[:, None], [1.0, *turns, -1.0 - sum(turns)], out=block[1:])
            turns = v_2 / area, -v_1 / area
            block[1:] += step_width.derivative[:, None] * [0.0, *turns, -sum(turns)]

        return FinalPose(Dual(filled(beta.tape, (*beta.block.shape, 4), fill), beta.tape), J)

    def impact(self, final: FinalPose, dq_minus: Dual) -> Dual:
        """(11,) relabelled dq+ (4), impulse (3), lift-off (2) and touchdown (2) vertical velocities of the soles.

        Differentiates M (v+ - v-) = J' L and J v+ = 0 with respect to q and v-.

        Args:
            final: as `pose` finds it.
            dq_minus: (4,) velocities.
        """
        q_minus, J = final

        def fill(block: FloatArray) -> None:
            rows = self._impact(q_minus.value, J, dq_minus.value)
            block[0] = rows[:, 0]
            np.matmul(q_minus.derivative, rows[:, 1:5].T, out=block[1:])
            block[1:] += dq_minus.derivative @ rows[:, 5:].T

        return Dual(filled(q_minus.tape, (len(q_minus.block), 11), fill), q_minus.tape)

    def _impact(self, q_minus: FloatArray, J: FloatArray, dq_minus: FloatArray) -> FloatArray:
        """(11, 9) the rows of `impact`: their values, derivatives by q- and derivatives by dq-."""
        biped, q = self._biped, self._q
        q[BASE:] = q_minus
        M = biped.floating_mass_matrix(q_minus)
        inverse = pin.computeKKTContactDynamicMatrixInverse(self._weightless, self._data, q, J)
        solved = np.empty((SPEEDS + 3, 9))  # (v+, -L) and their derivatives
        # a foot that weighs little costs the inverse two digits, which one step of refinement gives back
        matrix, right_v, by_v = self._matrix, self._right_v, solved[:, 5:]
        matrix[:SPEEDS, :SPEEDS], matrix[SPEEDS:, :SPEEDS], matrix[:SPEEDS, SPEEDS:] = M, J, J.T
        right_v[:SPEEDS] = M[:, BASE:]
        np.matmul(inverse, right_v, out=by_v)
        by_v += inverse @ (right_v - matrix @ by_v)
        np.matmul(solved[:, 5:], dq_minus, out=solved[:, 0])
        v_plus, (L_h, L_v, _) = solved[:SPEEDS, 0], -solved[SPEEDS:, 0]
        change = v_plus.copy()
        change[BASE:] -= dq_minus

        pin.computeRNEADerivatives(self._weightless, self._data, q, _NO_SPEED, change)
        turned_h, turned_v = turned = J[:2, _LATER]  # quarter turns of them are dJ/dq
        right = np.zeros((SPEEDS + 3, 4))
        right[_TURNING] = L_v * turned_h - L_h * turned_v  # d(J' L)/dq
        right[:SPEEDS] -= self._data.dtau_dq[:, BASE:]  # d(M dv)/dq
        pushed_h, pushed_v = v_plus[_TURNING] @ turned
        right[SPEEDS], right[SPEEDS + 1] = pushed_v, -pushed_h  # d(J v+)/dq
        np.matmul(inverse, right, out=solved[:, 1:5])

        rows = np.empty((11, 9))
        np.matmul(self._rows, solved, out=rows[:9])
        # vertical velocity of a sole end = that of the ankle + rotation rate * horizontal lever, the foot being flat
        by_dq = np.add(J[1, BASE:], self._ends, out=rows[9:, 5:])
        np.matmul(by_dq, dq_minus, out=rows[9:, 0])
        np.add(dq_minus @ turned_h[1:], np.add.reduce(dq_minus) * biped.ankle_height, out=rows[9:, 1:5])
        return rows
