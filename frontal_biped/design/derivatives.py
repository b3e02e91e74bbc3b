"""Exact derivatives of the calls into Pinocchio, as rules for `Dual` arrays.

Inverse dynamics along a curve needs only first derivatives of RNEA without gravity at (q, q', q''), which is B. They
tell A = M q', that at (q, 0, q'), and G, what a ground accelerated upwards by g would ask for, and their derivatives
(`design.side_by_side`). No second derivative of the model appears. Each node is differentiated by its own q, q', q''
(4 each), and one product per node takes these to the P variables.
"""

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual, chain
from frontal_biped.design.side_by_side import GROUND, side_by_side
from frontal_biped.design.tape import computed
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.impact import landing_jacobian
from frontal_biped.model.space.plane_masses import PlaneDynamics, PlaneMasses
from frontal_biped.virtual_constraints.invariance import double_support_pose
from frontal_biped.virtual_constraints.phase import ConstrainedMotion
from frontal_biped.zero_dynamics.restricted import ProjectedDynamics, RestrictedDynamics

WIDTH = BASE + 4


class Projection(NamedTuple):
    """What the model has to say along a curve of n configurations.

    Attributes:
        restricted: the scalar dynamics.
        soles: (2, n) heights of the swing sole's inner and outer end [m].
    """

    restricted: RestrictedDynamics
    soles: FloatArray


class DifferentiableBiped:
    """Final pose, impact, projected dynamics and sole heights of a robot, for `Dual` motions."""

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped, self._many = biped, side_by_side(biped)
        self._weightless = biped.floating.copy()
        self._weightless.gravity.linear = np.zeros(3)
        self._data = self._weightless.createData()
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

        def block() -> FloatArray:
            pose = double_support_pose(self.biped, beta.value.item(), step_width.value.item())
            q = np.zeros(WIDTH)
            q[BASE:] = pose
            J = landing_jacobian(self.biped, q)[:, BASE:]
            by_both = np.empty((4, 2))
            by_both[0] = 1.0, 0.0
            by_both[1:] = np.linalg.solve(J[:, 1:], np.array([-J[:, 0], [1.0, 0.0, 0.0]]).T)
            return Dual.of(pose, np.stack([beta.derivative, step_width.derivative], axis=1) @ by_both.T).block

        return Dual(computed(beta.tape, block), beta.tape)

    def project(self, motion: ConstrainedMotion) -> Projection:
        """`zero_dynamics.on_constraints` and the sole heights, for a `Dual` motion of n nodes."""
        tape, nodes = cast("Dual", motion.q).tape, _NodeDynamics()

        def block() -> FloatArray:
            at = nodes.at = _NodeVariables.of(motion)
            n = len(at.q)
            moving = self._many.at(at.q, at.dq, at.ddq)  # B
            from_rest, weight = self._many.from_rest(moving, at.dq), self._many.weight(moving.by_ddq)  # A, G
            values, local = np.empty((3, WIDTH, n)), np.zeros((3, n, WIDTH, 10))
            values[0], values[1], values[2] = from_rest.tau.T, moving.tau.T, weight.tau.T
            local[0, :, :, :4], local[1, :, :, :4], local[2, :, :, :4] = from_rest.by_q, moving.by_q, weight.by_q
            local[0, :, :, 4:7] = local[1, :, :, 7:] = moving.by_ddq[:, :, 1:]
            local[1, :, :, 4:7] = moving.by_dq[:, :, 1:]
            nodes.values, nodes.local = values, local
            rows, by_node = np.empty((n, 11)), np.zeros((n, 11, 10))
            rows[:, :9] = values[:, GROUND].reshape(9, n).T
            by_node[:, :9].reshape(n, 3, BASE, 10)[:] = local[:, :, GROUND].transpose(1, 0, 2, 3)
            rows[:, 9:], by_node[:, 9:, :4] = self._sole_heights(at.q, moving.J)
            return at.carried(rows, by_node)

        rows = Dual(computed(tape, block), tape)
        projected = ProjectedDynamics(*(cast("FloatArray", rows[BASE * i : BASE * (i + 1)]) for i in range(3)))
        restricted = DifferentiatedDynamics(projected, motion.p_fri, motion.dp_fri, nodes)
        return Projection(restricted, cast("FloatArray", rows[3 * BASE :]))

    def _sole_heights(self, q: FloatArray, J: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(n, 2) heights of both ends and (n, 2, 4) derivatives.

        Turning a joint moves a point by a quarter turn of its lever: the columns of J (n, 2, 4), the velocity of the
        world's origin as if it belonged to the foot, are the vertical and minus the horizontal place of each joint.
        """
        rotation = self.biped.swing_foot_rotation(q)[:, None]
        h_a = self.biped.ankle_height
        ends = np.array([-self.biped.chain.sole_inner, self.biped.chain.sole_outer])
        cos, sin = np.cos(rotation), np.sin(rotation)
        ankle_h, ankle_v = -J[:, 1, -1:], J[:, 0, -1:]
        horizontal = ankle_h + cos * ends + sin * h_a
        return ankle_v + sin * ends - cos * h_a, horizontal[:, :, None] + J[:, None, 1]

    def impact(self, q_minus: Dual, dq_minus: Dual) -> Dual:
        """(11,) relabelled dq+ (4), impulse (3), lift-off (2) and touchdown (2) vertical velocities of the soles.

        Differentiates M (v+ - v-) = J' L and J v+ = 0 with respect to q and v-.
        """
        return Dual(computed(q_minus.tape, lambda: self._impact(q_minus, dq_minus)), q_minus.tape)

    def _impact(self, q_minus: Dual, dq_minus: Dual) -> FloatArray:
        biped, data = self.biped, self._data
        q, v_minus = np.zeros(WIDTH), np.zeros(WIDTH)
        q[BASE:], v_minus[BASE:] = q_minus.value, dq_minus.value
        J = landing_jacobian(biped, q)
        M = biped.floating_mass_matrix(q_minus.value)
        kkt = np.zeros((WIDTH + 3, WIDTH + 3))
        kkt[:WIDTH, :WIDTH], kkt[:WIDTH, WIDTH:], kkt[WIDTH:, :WIDTH] = M, -J.T, J
        inverse = np.linalg.inv(kkt)
        solution = inverse[:, :WIDTH] @ (M @ v_minus)
        v_plus, L = solution[:WIDTH], solution[WIDTH:]

        pin.computeRNEADerivatives(self._weightless, data, q, np.zeros(WIDTH), v_plus - v_minus)
        right_q = np.empty((WIDTH + 3, 4))
        hessian = _planar_hessian(J)
        right_q[:WIDTH] = (L @ hessian.reshape(3, -1)).reshape(WIDTH, WIDTH)[:, BASE:]  # d(J' L)/dq
        right_q[:WIDTH] -= data.dtau_dq[:, BASE:]  # d(M dv)/dq
        right_q[WIDTH:] = -(v_plus @ hessian)[:, BASE:]  # d(J v+)/dq
        solution_q, solution_v = inverse @ right_q, inverse[:, :WIDTH] @ M[:, BASE:]

        # vertical velocity of a sole end = that of the ankle + rotation rate * horizontal lever, flat at impact
        heights_q = self._sole_heights(q_minus.value[None], data.J[None, :2, BASE:])[1][0]
        rate = float(J[2] @ v_minus)
        rotation = biped.swing_foot_rotation(q_minus.value)
        ends = np.array([-biped.chain.sole_inner, biped.chain.sole_outer])
        levers_q = -np.sin(rotation) * ends + np.cos(rotation) * biped.ankle_height
        touch_q = (v_minus @ hessian)[1, BASE:] + rate * levers_q[:, None]
        rows = self._landing_rows
        value = np.concatenate([rows @ solution, heights_q @ dq_minus.value])
        by_q = np.concatenate([rows @ solution_q, touch_q])
        by_v = np.concatenate([rows @ solution_v, heights_q])
        both = chain(value, by_q, q_minus).block
        both[1:] += dq_minus.derivative @ by_v.T
        return both


@dataclass(frozen=True)
class _NodeVariables:
    """What each of n nodes is differentiated by: q, q', q'', the last two without the stance ankle's, which are fixed.

    Attributes:
        q: (n, 4) [rad].
        dq: (n, 4) [-].
        ddq: (n, 4) [1/rad].
        inner: (n, 10, P) their derivatives.
    """

    q: FloatArray
    dq: FloatArray
    ddq: FloatArray
    inner: FloatArray

    @classmethod
    def of(cls, motion: ConstrainedMotion) -> "_NodeVariables":
        """The nodes of a `Dual` motion."""
        q, dq, ddq = (cast("Dual", motion[part]).block for part in range(3))
        inner = np.concatenate([q[1:], dq[1:, :, 1:], ddq[1:, :, 1:]], axis=2).transpose(1, 2, 0)
        return cls(q[0], dq[0], ddq[0], np.ascontiguousarray(inner))

    def carried(self, values: FloatArray, local: FloatArray, *further: FloatArray) -> FloatArray:
        """From each node's own variables to all P.

        Args:
            values: (n, rows) at the nodes.
            local: (n, rows, 10 + f) their derivatives, columns as in ``inner``, then those of ``further``.
            further: f more variables of a node, the derivatives (P, n) of each.

        Returns:
            (1 + P, rows, n), the block of a `Dual`.
        """
        inner = self.inner
        if further:
            inner = np.concatenate([inner, np.stack(further).transpose(2, 0, 1)], axis=1)
        block = np.empty((1 + inner.shape[2], values.shape[1], len(values)))
        block[0], block[1:] = values.T, (local @ inner).transpose(2, 1, 0)
        return block


class _NodeDynamics:
    """A, B and G of w = A ddbeta + B dbeta^2 + G at n nodes, as last computed.

    Attributes:
        at: what the nodes are differentiated by.
        values: (3, 7, n) A, B, G; rows as in `zero_dynamics.restricted`.
        local: (3, n, 7, 10) their derivatives.
    """

    at: _NodeVariables
    values: FloatArray
    local: FloatArray

    def forces(self, acceleration: Dual, squared: Dual) -> FloatArray:
        """(1 + P, 7, n) of w, each node differentiated by ddbeta and dbeta^2 as well before it is carried to all P."""
        (A, B, G), (A_by, B_by, G_by) = self.values, self.local
        a, b = acceleration.value, squared.value
        local = np.empty((len(a), WIDTH, 12))
        np.multiply(A_by, a[:, None, None], out=local[:, :, :10])
        local[:, :, :10] += B_by * b[:, None, None]
        local[:, :, :10] += G_by
        local[:, :, 10], local[:, :, 11] = A.T, B.T
        return self.at.carried((A * a + B * b + G).T, local, acceleration.derivative, squared.derivative)


@dataclass(frozen=True)
class DifferentiatedDynamics(RestrictedDynamics):
    """The scalar dynamics of a `Dual` motion; of A, B and G it has the rows of the ground, all that the orbit needs."""

    nodes: _NodeDynamics

    def forces(self, dbeta_squared: FloatArray) -> FloatArray:
        """As `RestrictedDynamics`."""
        squared, acceleration = cast("Dual", dbeta_squared), cast("Dual", self.acceleration(dbeta_squared))
        block = computed(squared.tape, lambda: self.nodes.forces(acceleration, squared))
        return cast("FloatArray", Dual(block, squared.tape))


def plane_dynamics(masses: PlaneMasses, motions: list[ConstrainedMotion]) -> list[PlaneDynamics]:
    """`PlaneMasses.along` for `Dual` motions."""
    return [_plane_dynamics(masses, motion) for motion in motions]


def _plane_dynamics(masses: PlaneMasses, motion: ConstrainedMotion) -> PlaneDynamics:
    tape = cast("Dual", motion.q).tape

    def block() -> FloatArray:
        at = _NodeVariables.of(motion)
        local = np.zeros((3, 11, len(at.q), 4))
        local[:, 0] = at.q, at.dq, at.ddq
        for variable, (part, joint) in enumerate(_LOCAL):
            local[part, 1 + variable, :, joint] = 1.0
        found = masses.along(*(cast("FloatArray", Dual(own)) for own in local))
        each = np.concatenate([cast("Dual", part).block for part in found], axis=1)  # (11, 15, n)
        return at.carried(each[0].T, each[1:].transpose(2, 1, 0))

    rows = Dual(computed(tape, block), tape)
    return PlaneDynamics(*(cast("FloatArray", rows[5 * i : 5 * i + 5]) for i in range(3)))


_LOCAL = [*((0, joint) for joint in range(4)), *((part, joint) for part in (1, 2) for joint in range(1, 4))]
"""What a node is differentiated by: q, q' or q'' (0, 1, 2) of which joint."""


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
