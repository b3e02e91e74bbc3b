"""Exact derivatives of the calls into Pinocchio, as rules for `Dual` arrays.

Inverse dynamics along a curve needs only first derivatives of RNEA without gravity at (q, q', q''), which is B. They
tell A = M q', that at (q, 0, q'), and G, what a ground accelerated upwards by g would ask for, and their derivatives
(`design.side_by_side`). No second derivative of the model appears. Each node is differentiated by its own q, q', q''
(4 each), and one product per node takes these to the P variables.
"""

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.side_by_side import GROUND, side_by_side
from frontal_biped.design.tape import computed
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.space.plane_masses import PlaneDynamics, PlaneMasses
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
    """Projected dynamics and sole heights of a robot, for `Dual` motions."""

    def __init__(self, biped: FrontalBiped) -> None:
        self.biped, self._many = biped, side_by_side(biped)

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
