r"""The input-output linearising torque at many states at once, where no limit is active at any of them.

As for one state (`linearisation`): the accelerations that give the outputs theirs are a line a + c ddbeta, the forces
along it are W = W_0 + W_1 ddbeta, and the FRI's target gives ddbeta. Here W_0 and W_0 + W_1 are the inverse dynamics of
the accelerations a and a + c, all states in one call.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limits import ContactLimits, WalkingLimits
from frontal_biped.control.torques.linearisation import F_H, F_V, N_0, Motion
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.phase import ConstrainedMotion


def linearising_motions(biped: FrontalBiped, states: State, wanted: ConstrainedMotion, ddy: FloatArray) -> Motion:
    """The motions that meet all targets; not finite where I_P vanishes.

    Args:
        biped: the robot.
        states: q, dq (m, 4).
        wanted: the virtual constraints at the states' beta (m,), whose FRI is the target.
        ddy: (m, 3) wanted output accelerations [rad/s^2].

    Returns:
        Accelerations (m, 4) and forces (m, 7).
    """
    q, dq = states
    line = np.zeros((2, *q.shape))
    a, c = line  # slope and curvature of the virtual constraints are those of q, whose first entry is beta itself
    np.multiply(wanted.ddq, dq[:, :1] ** 2, out=a)
    a[:, 1:] += ddy
    c[:] = wanted.dq
    c += a
    W_0, W_1 = biped.many.inverse_dynamics(q, dq, line)
    W_1 = W_1 - W_0
    with np.errstate(divide="ignore", invalid="ignore"):
        ddbeta = (wanted.p_fri * W_0[:, F_V] - W_0[:, N_0]) / (W_1[:, N_0] - wanted.p_fri * W_1[:, F_V])
        ddbeta = ddbeta[:, None]
        return Motion(a + wanted.dq * ddbeta, W_0 + W_1 * ddbeta)


def keep_all(limits: WalkingLimits, states: State, motions: Motion) -> bool:
    """Do motions at states meet every constraint, each of them? One that is not finite does not."""
    if not _loads_keep(limits.contact, motions.forces):
        return False
    if limits.joints is None:
        return True
    lower, upper = limits.joints.bounds(states)
    return bool(((lower <= motions.ddq) & (motions.ddq <= upper)).all())


def _loads_keep(contact: ContactLimits, forces: FloatArray) -> bool:
    """Are forces (m, 7) within the limits of contact and motors?"""
    F_h, F_v, N_0_ = forces[:, F_H], forces[:, F_V], forces[:, N_0]
    stands = (F_v >= contact.min_normal_force) & (np.abs(F_h) <= contact.friction * F_v)
    stands &= (contact.fri_outer * F_v <= N_0_) & (contact.fri_inner * F_v >= N_0_)
    return bool(stands.all() and (np.abs(forces[:, BASE:]) <= contact.max_torque).all())
