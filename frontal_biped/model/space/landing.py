r"""Rigid landing of a foot with every joint free: motors give no impulses, so only rotor inertia holds a joint.

.. math::
    M (v^+ - v^-) = J^T \Lambda, \qquad J v^+ = 0,

J the Jacobian of the landing sole, six rows: it sticks flat on the ground; the old stance foot is free to leave. M
holds the reflected rotor inertia of the joints. Where that grows beyond all bounds for every joint but the four roll
joints, the foot at rest leaves no motion but theirs, which is one in the frontal plane: the landing is the planar
`impact`.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance

SINGULAR = 1e-10
"""Eigenvalue of the mass matrix, its diagonal scaled to one, below which a motion moves no mass.

Some URDFs have links without inertia. No impulse reaches such a motion, and it is left as it was.
"""


class SpatialLanding(NamedTuple):
    """What a landing does.

    Attributes:
        v_plus: (nv,) velocity after it.
        impulse: (6,) on the landing sole: force [N s], and moment about the origin of its frame [N m s], heading frame.
        energy_before: kinetic, of bodies and rotors, of what is not held [J].
        energy_after: likewise.
    """

    v_plus: FloatArray
    impulse: FloatArray
    energy_before: float
    energy_after: float

    @property
    def cop(self) -> FloatArray:
        """(2,) x and y where the impulse acts on the sole, from its origin [m]."""
        _, _, F_z, M_x, M_y, _ = self.impulse
        return np.array([-M_y, M_x]) / F_z

    @property
    def friction_used(self) -> float:
        """Coefficient of friction that keeps the foot from slipping, its yaw moment aside; inf if the ground pulls."""
        F_x, F_y, F_z = self.impulse[:3].tolist()
        return float(np.hypot(F_x, F_y) / F_z) if F_z > 0.0 else float("inf")


def land(space: SpaceState, side: Stance, armature: FloatArray | None = None) -> SpatialLanding:
    """Land a foot.

    Args:
        space: the robot at the state before, its landing sole flat on the ground.
        side: the landing foot.
        armature: (n,) reflected rotor inertia of the joints [kg m^2], inf where a joint is held: its rate stays; None:
            the robot's.
    """
    own = space.free.armature
    armature = own if armature is None else armature
    free = np.flatnonzero(np.concatenate([np.ones(BASE), np.isfinite(armature)]))
    M = space.M + np.diag(np.concatenate([np.zeros(BASE), np.where(np.isfinite(armature), armature, own) - own]))
    M, J, v = M[np.ix_(free, free)], space.feet[side].J, space.v
    scale = 1.0 / np.sqrt(np.diag(M))
    values, vectors = np.linalg.eigh(scale[:, None] * M * scale)
    moves = values > SINGULAR
    root = scale[:, None] * vectors[:, moves] / np.sqrt(values[moves])  # its square is the inverse of M
    reached = J[:, free] @ root
    # least squares rather than normal equations: rotors of any size leave all digits
    kick, *_ = np.linalg.lstsq(reached, -J @ v)
    impulse, *_ = np.linalg.lstsq(reached.T, kick)
    v_plus = v.copy()
    v_plus[free] += root @ kick
    before, after = (0.5 * float(part[free] @ M @ part[free]) for part in (v, v_plus))
    return SpatialLanding(v_plus, impulse, before, after)
