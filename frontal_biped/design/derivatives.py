"""Exact derivatives of the calls into Pinocchio, as rules for `Dual` arrays.

Inverse dynamics along a curve needs only first derivatives of RNEA: A = M q' is RNEA without gravity and velocity,
B + G is RNEA at (q, q', q''), G at rest. No second derivative of the model appears. Each node is differentiated by
its own q, q', q'' (4 each), and one product per node takes these to the P variables.
"""

from typing import NamedTuple, cast

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual, chain
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.impact import landing_jacobian
from frontal_biped.model.space.plane_masses import PlaneDynamics, PlaneMasses
from frontal_biped.virtual_constraints.invariance import double_support_pose
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics

WIDTH = BASE + 4
_A, _B, _G, _SOLE = slice(0, WIDTH), slice(WIDTH, 2 * WIDTH), slice(2 * WIDTH, 3 * WIDTH), slice(3 * WIDTH, None)
_ROWS = 3 * WIDTH + 2


class Projection(NamedTuple):
    """What the model has to say along a curve of n configurations.

    Attributes:
        dynamics: A, B, G, each (7, n).
        soles: (2, n) heights of the swing sole's inner and outer end [m].
    """

    dynamics: ProjectedDynamics
    soles: FloatArray


class _Calls:
    """One Pinocchio model with its work data, and views of the results: reading them afresh costs as much as a call."""

    def __init__(self, model: pin.Model) -> None:
        self.model = model
        self.data = model.createData()
        self.tau, self.g, self.M, self.J = self.data.tau, self.data.g, self.data.M, self.data.J
        self.dtau_dq, self.dtau_dv = self.data.dtau_dq, self.data.dtau_dv
        self.swing_ankle = self.data.oMi[model.njoints - 1].translation

    def __call__(self, q: FloatArray, v: FloatArray, a: FloatArray) -> None:
        pin.computeRNEADerivatives(self.model, self.data, q, v, a)


class DifferentiableBiped:
    """Final pose, impact, projected dynamics and sole heights of a robot, for `Dual` motions."""

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped = biped
        weightless = biped.floating.copy()
        weightless.gravity.linear = np.zeros(3)
        self._heavy, self._weightless = _Calls(biped.floating.copy()), _Calls(weightless)
        # rows of the landing that are linear in (v+, L)
        outer, inner = biped.sole
        select = np.zeros((9, WIDTH + 3))
        select[:4, BASE:WIDTH] = np.eye(4)[::-1]
        select[4:7, WIDTH:] = np.eye(3)
        select[6, WIDTH] = -biped.ankle_height
        select[7:, 1] = 1.0
        select[7:, 2] = inner, outer
        self._landing_rows = select

    def double_support_pose(self, beta: Dual, step_width: Dual) -> Dual:
        """(4,) `virtual_constraints.double_support_pose`.

        By the implicit function theorem: the swing ankle stays at (step width, h_a) and the swing foot flat.
        """
        pose = double_support_pose(self.biped, float(beta), float(step_width))
        q = np.zeros(WIDTH)
        q[BASE:] = pose
        J = landing_jacobian(self.biped, q)[:, BASE:]
        by_both = np.empty((4, 2))
        by_both[0] = 1.0, 0.0
        by_both[1:] = np.linalg.solve(J[:, 1:], np.array([-J[:, 0], [1.0, 0.0, 0.0]]).T)
        return Dual.of(pose, np.stack([beta.derivative, step_width.derivative], axis=1) @ by_both.T)

    def project(self, motions: list[ConstrainedMotion]) -> list[Projection]:
        """`zero_dynamics.project_dynamics` and the sole heights, for `Dual` motions, all of them in one pass."""
        blocks = _blocks(motions)
        values, local = self._local(*(block[0] for block in blocks))
        projections = []
        for rows in _by_motion(values, local, blocks, motions):
            A, B, G, soles = (cast("FloatArray", rows[part]) for part in (_A, _B, _G, _SOLE))
            projections.append(Projection(ProjectedDynamics(A, B, G), soles))
        return projections

    def _local(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n, rows) values and (n, rows, 10) derivatives with respect to q (4), dq (last 3) and ddq (last 3)."""
        n = len(q)
        tau_A, tau_B, tau_G = np.empty((3, n, WIDTH))
        A_q, B_q, G_q, B_dq, M = np.empty((5, n, WIDTH, WIDTH))
        J_v, ankle = np.empty((n, WIDTH)), np.empty((n, 3))
        rest = np.zeros(WIDTH)
        padded = np.zeros((3, n, WIDTH))
        padded[0, :, BASE:], padded[1, :, BASE:], padded[2, :, BASE:] = q, dq, ddq
        heavy, weightless = self._heavy, self._weightless
        for i, (x, dx, ddx) in enumerate(zip(*padded, strict=True)):
            G_q[i] = pin.computeGeneralizedGravityDerivatives(heavy.model, heavy.data, x)
            tau_G[i] = heavy.g
            heavy(x, dx, ddx)
            tau_B[i], B_q[i], B_dq[i], M[i] = heavy.tau, heavy.dtau_dq, heavy.dtau_dv, heavy.M
            weightless(x, rest, dx)
            tau_A[i], A_q[i] = weightless.tau, weightless.dtau_dq
            J_v[i], ankle[i] = weightless.J[1], weightless.swing_ankle
        values = np.concatenate([tau_A, tau_B - tau_G, tau_G, np.empty((n, 2))], axis=1)
        local = np.zeros((n, _ROWS, 10))
        local[:, _A, :4], local[:, _A, 4:7] = A_q[:, :, BASE:], M[:, :, BASE + 1 :]
        local[:, _B, :4] = B_q[:, :, BASE:] - G_q[:, :, BASE:]
        local[:, _B, 4:7], local[:, _B, 7:] = B_dq[:, :, BASE + 1 :], M[:, :, BASE + 1 :]
        local[:, _G, :4] = G_q[:, :, BASE:]
        values[:, _SOLE], local[:, _SOLE, :4] = self._sole_heights(q, ankle, J_v[:, BASE:])
        return values, local

    def _sole_heights(self, q: FloatArray, ankle: FloatArray, J_v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n, 2) heights of both ends and (n, 2, 4) derivatives.

        Turning a joint lifts a point by its horizontal lever; row 1 of the world Jacobian J_v (n, 4) is minus the
        horizontal position of each joint.
        """
        rotation = self.biped.swing_foot_rotation(q)[:, None]
        h_a = self.biped.ankle_height
        ends = np.array([-self.biped.chain.sole_inner, self.biped.chain.sole_outer])
        cos, sin = np.cos(rotation), np.sin(rotation)
        heights = ankle[:, 1:2] + sin * ends - cos * h_a
        horizontal = ankle[:, 0:1] + cos * ends + sin * h_a
        return heights, horizontal[:, :, None] + J_v[:, None, :]

    def impact(self, q_minus: Dual, dq_minus: Dual) -> Dual:
        """(11,) relabelled dq+ (4), impulse (3), lift-off (2) and touchdown (2) vertical velocities of the soles.

        Differentiates M (v+ - v-) = J' L and J v+ = 0 with respect to q and v-.
        """
        biped, weightless = self.biped, self._weightless
        q, v_minus = np.zeros(WIDTH), np.zeros(WIDTH)
        q[BASE:], v_minus[BASE:] = q_minus.value, dq_minus.value
        J = landing_jacobian(biped, q)
        M = biped.floating_mass_matrix(q_minus.value)
        kkt = np.zeros((WIDTH + 3, WIDTH + 3))
        kkt[:WIDTH, :WIDTH], kkt[:WIDTH, WIDTH:], kkt[WIDTH:, :WIDTH] = M, -J.T, J
        inverse = np.linalg.inv(kkt)
        solution = inverse[:, :WIDTH] @ (M @ v_minus)
        v_plus, L = solution[:WIDTH], solution[WIDTH:]

        weightless(q, np.zeros(WIDTH), v_plus - v_minus)
        right_q = np.empty((WIDTH + 3, 4))
        hessian = _planar_hessian(J)
        right_q[:WIDTH] = (L @ hessian.reshape(3, -1)).reshape(WIDTH, WIDTH)[:, BASE:]  # d(J' L)/dq
        right_q[:WIDTH] -= weightless.dtau_dq[:, BASE:]  # d(M dv)/dq
        right_q[WIDTH:] = -(v_plus @ hessian)[:, BASE:]  # d(J v+)/dq
        solution_q, solution_v = inverse @ right_q, inverse[:, :WIDTH] @ M[:, BASE:]

        # vertical velocity of a sole end = that of the ankle + rotation rate * horizontal lever, flat at impact
        heights_q = self._sole_heights(q_minus.value[None], weightless.swing_ankle[None], weightless.J[1:2, BASE:])[1][
            0
        ]
        rate = float(J[2] @ v_minus)
        rotation = biped.swing_foot_rotation(q_minus.value)
        ends = np.array([-biped.chain.sole_inner, biped.chain.sole_outer])
        levers_q = -np.sin(rotation) * ends + np.cos(rotation) * biped.ankle_height
        touch_q = (v_minus @ hessian)[1, BASE:] + rate * levers_q[:, None]
        rows = self._landing_rows
        value = np.concatenate([rows @ solution, heights_q @ dq_minus.value])
        by_q = np.concatenate([rows @ solution_q, touch_q])
        by_v = np.concatenate([rows @ solution_v, heights_q])
        both = chain(value, by_q, q_minus)
        both.derivative[:] += dq_minus.derivative @ by_v.T
        return both


def plane_dynamics(masses: PlaneMasses, motions: list[ConstrainedMotion]) -> list[PlaneDynamics]:
    """`PlaneMasses.along` for `Dual` motions, all of them in one pass."""
    blocks = _blocks(motions)
    n = blocks[0].shape[1]
    local = [np.zeros((11, n, 4)) for _ in blocks]
    for block, at in zip(local, blocks, strict=True):
        block[0] = at[0]
    for variable, (part, joint) in enumerate(_LOCAL):
        local[part][1 + variable, :, joint] = 1.0
    found = masses.along(*(cast("FloatArray", Dual(block)) for block in local))
    each = np.concatenate([cast("Dual", part).block for part in found], axis=1)  # (11, 15, n)
    rows = _by_motion(each[0].T, each[1:].transpose(2, 1, 0), blocks, motions)
    return [PlaneDynamics(*(cast("FloatArray", row[5 * i : 5 * i + 5]) for i in range(3))) for row in rows]


_LOCAL = [*((0, joint) for joint in range(4)), *((part, joint) for part in (1, 2) for joint in range(1, 4))]
"""What a node is differentiated by: q, q' or q'' (0, 1, 2) of which joint; q' and q'' of the stance ankle are fixed."""


def _blocks(motions: list[ConstrainedMotion]) -> list[FloatArray]:
    """(1 + P, n, 4) q, q', q'' of all motions, one behind the other."""
    return [np.concatenate([cast("Dual", motion[part]).block for motion in motions], axis=1) for part in range(3)]


def _by_motion(
    values: FloatArray, local: FloatArray, blocks: list[FloatArray], motions: list[ConstrainedMotion]
) -> list[Dual]:
    """From each node's own variables to all P.

    Args:
        values: (n, rows) at the nodes.
        local: (n, rows, 10) their derivatives, columns as in `_LOCAL`.
        blocks: of `_blocks`.
        motions: to which the nodes belong.

    Returns:
        The rows (rows, n) of each motion.
    """
    q, dq, ddq = blocks
    inner = np.concatenate([q[1:], dq[1:, :, 1:], ddq[1:, :, 1:]], axis=2).transpose(1, 2, 0)
    block = np.concatenate([values[:, :, None], local @ inner], axis=2).transpose(2, 1, 0)  # (1 + P, rows, n)
    ends = np.cumsum([len(motion.q) for motion in motions])[:-1]
    return [Dual(np.ascontiguousarray(part)) for part in np.split(block, ends, axis=2)]


def _planar_hessian(J: FloatArray) -> FloatArray:
    """(3, 7, 7) derivative of the landing Jacobian: [row, column, variable].

    Turning joint j moves the lever of joint i <= j as a whole, so dJ_i/dq_j is the quarter turn of J_j, and by
    symmetry of second derivatives the later of the two joints counts. Translations and the rotation row are constant.
    """
    hessian = np.zeros((3, WIDTH, WIDTH))
    hessian[0, 2:, 2:] = -J[1, _LATER]
    hessian[1, 2:, 2:] = J[0, _LATER]
    return hessian


_LATER = np.maximum.outer(np.arange(2, WIDTH), np.arange(2, WIDTH))
