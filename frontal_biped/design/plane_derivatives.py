"""Exact derivatives of what the ground must hold while the whole robot moves in its frontal plane.

`PlaneMasses.along` is asked of arrays differentiated by each node's own q, q', q'', and one product per node takes the
derivatives to the P variables.
"""

from dataclasses import dataclass
from typing import cast

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.design.forward_mode import Dual
from frontal_biped.design.tape import computed
from frontal_biped.model.space.plane_masses import PlaneDynamics, PlaneMasses
from frontal_biped.virtual_constraints.phase import ConstrainedMotion


@dataclass(frozen=True)
class _NodeVariables:
    """What each of n nodes of a motion in space is differentiated by: q, q', q''.

    Of q' and q'' without the stance ankle's, which are fixed.

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

    def carried(self, values: FloatArray, local: FloatArray) -> FloatArray:
        """From each node's own variables to all P.

        Args:
            values: (n, rows) at the nodes.
            local: (n, rows, 10) their derivatives, columns as in ``inner``.

        Returns:
            (1 + P, rows, n), the block of a `Dual`.
        """
        block = np.empty((1 + self.inner.shape[2], values.shape[1], len(values)))
        block[0], block[1:] = values.T, (local @ self.inner).transpose(2, 1, 0)
        return block


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
