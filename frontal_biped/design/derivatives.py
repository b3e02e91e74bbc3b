"""Exact derivatives of the calls into Pinocchio, as rules for `Dual` arrays.

Inverse dynamics along a curve needs only first derivatives of RNEA: A = M q' is RNEA without gravity and velocity,
B + G is RNEA at (q, q', q''), G at rest. No second derivative of the model appears.
"""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual, chain
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.impact import landing_jacobian
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics import ProjectedDynamics


class DifferentiableBiped:
    """Projected dynamics, sole heights and impact of a robot, for `Dual` motions."""

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped = biped
        self._model = biped.floating
        self._data = biped.floating.createData()
        self._weightless = biped.floating.copy()
        self._weightless.gravity.linear = np.zeros(3)
        self._weightless_data = self._weightless.createData()

    def project_dynamics(self, motion: ConstrainedMotion) -> ProjectedDynamics:
        """`zero_dynamics.project_dynamics` for a `Dual` motion; each part (7, n)."""
        q, dq, ddq = motion.q, motion.dq, motion.ddq
        assert isinstance(q, Dual) and isinstance(dq, Dual) and isinstance(ddq, Dual)
        n = len(q)
        width = BASE + 4
        A, B, G = np.empty((n, width)), np.empty((n, width)), np.empty((n, width))
        A_q, G_q = np.empty((n, width, 4)), np.empty((n, width, 4))
        B_q, B_dq = np.empty((n, width, 4)), np.empty((n, width, 4))
        M = np.empty((n, width, 4))
        padded = [np.zeros((n, width)) for _ in range(3)]
        for full, part in zip(padded, (q, dq, ddq), strict=True):
            full[:, BASE:] = part.value
        rest = np.zeros(width)
        model, data, weightless, no_weight = self._model, self._data, self._weightless, self._weightless_data
        for i, (x, dx, ddx) in enumerate(zip(*padded, strict=True)):
            pin.computeRNEADerivatives(model, data, x, rest, rest)
            G[i], G_q[i] = data.tau, data.dtau_dq[:, BASE:]
            pin.computeRNEADerivatives(model, data, x, dx, ddx)
            B[i], B_q[i], B_dq[i] = data.tau, data.dtau_dq[:, BASE:], data.dtau_dv[:, BASE:]
            pin.computeRNEADerivatives(weightless, no_weight, x, rest, dx)
            A[i], A_q[i] = no_weight.tau, no_weight.dtau_dq[:, BASE:]
            mass_matrix = no_weight.M  # computed for the derivative with respect to acceleration
            M[i] = mass_matrix[:, BASE:]
        B -= G
        B_q -= G_q
        return ProjectedDynamics(
            _rows(A, A_q @ q.derivative + M @ dq.derivative),
            _rows(B, B_q @ q.derivative + B_dq @ dq.derivative + M @ ddq.derivative),
            _rows(G, G_q @ q.derivative),
        )

    def swing_sole_heights(self, motion: ConstrainedMotion) -> Dual:
        """(2, n) heights of the swing sole's inner and outer end [m]."""
        q = motion.q
        assert isinstance(q, Dual)
        values = np.array([self.biped.swing_sole(point)[:, 1] for point in q.value])
        jacobians = np.array([self.biped.swing_sole_jacobian(point)[:, 1] for point in q.value])
        return _rows(values, jacobians @ q.derivative)

    def impact(self, q_minus: Dual, dq_minus: Dual) -> Dual:
        """(11,) relabelled dq+ (4), impulse (3), lift-off (2) and touchdown (2) vertical velocities of the soles.

        Differentiates M (v+ - v-) = J' L and J v+ = 0 with respect to q and v-.
        """
        biped = self.biped
        weightless, no_weight = self._weightless, self._weightless_data
        q, v_minus = np.zeros(BASE + 4), np.zeros(BASE + 4)
        q[BASE:], v_minus[BASE:] = q_minus.value, dq_minus.value
        J = landing_jacobian(biped, q)
        M = biped.floating_mass_matrix(q_minus.value)
        kkt = np.block([[M, -J.T], [J, np.zeros((3, 3))]])
        inverse = np.linalg.inv(kkt)
        solution = inverse @ np.concatenate([M @ v_minus, np.zeros(3)])
        v_plus, L = solution[: BASE + 4], solution[BASE + 4 :]

        pin.computeRNEADerivatives(weightless, no_weight, q, np.zeros(BASE + 4), v_plus - v_minus)
        momentum_q = no_weight.dtau_dq[:, BASE:]  # d(M dv)/dq
        hessian = _planar_hessian(J)
        force_q = np.einsum("k,kij->ij", L, hessian)[:, BASE:]  # d(J' L)/dq
        velocity_q = np.einsum("kij,i->kj", hessian, v_plus)[:, BASE:]  # d(J v+)/dq
        right_q = np.concatenate([force_q - momentum_q, -velocity_q])
        right_v = np.concatenate([M[:, BASE:], np.zeros((3, 4))])
        solution_q, solution_v = inverse @ right_q, inverse @ right_v

        outer, inner = biped.sole
        # rows of the outputs that are linear in the solution
        select = np.zeros((9, BASE + 4 + 3))
        select[:4, BASE : BASE + 4] = np.eye(4)[::-1]
        select[4:7, BASE + 4 :] = np.eye(3)
        select[6, BASE + 4] = -biped.ankle_height
        select[7:, 1] = 1.0
        select[7:, 2] = inner, outer
        touch_J = biped.swing_sole_jacobian(q_minus.value)[:, 1]
        ankle_q = np.einsum("kij,i->kj", hessian, v_minus)[:, BASE:]
        # vertical velocity of a sole end = that of the ankle + rotation rate * horizontal lever
        levers = biped.swing_sole(q_minus.value)[:, 0] - biped.joint_positions(q_minus.value)[3, 0]
        levers_q = biped.swing_sole_jacobian(q_minus.value)[:, 0] - J[0, BASE:]
        rate = float(J[2] @ v_minus)
        touch_q = ankle_q[1] + np.outer(levers, ankle_q[2]) + rate * levers_q
        value = np.concatenate([select @ solution, touch_J @ dq_minus.value])
        by_q = np.concatenate([select @ solution_q, touch_q])
        by_v = np.concatenate([select @ solution_v, touch_J])
        return Dual(value, chain(value, by_q, q_minus).derivative + chain(value, by_v, dq_minus).derivative)


def _planar_hessian(J: FloatArray) -> FloatArray:
    """(3, 7, 7) derivative of the landing Jacobian: [row, column, variable].

    Turning joint j moves the lever of joint i <= j as a whole, so dJ_i/dq_j is the quarter turn of J_j, and by
    symmetry of second derivatives the later of the two joints counts. Translations and the rotation row are constant.
    """
    hessian = np.zeros((3, BASE + 4, BASE + 4))
    turning = np.arange(2, BASE + 4)
    later = np.maximum.outer(turning, turning)
    hessian[0, 2:, 2:] = -J[1, later]
    hessian[1, 2:, 2:] = J[0, later]
    return hessian


def _rows(values: FloatArray, derivatives: FloatArray) -> Dual:
    """Node-first (n, k) and (n, k, P) to row-first."""
    return Dual(values.T, derivatives.swapaxes(0, 1))
