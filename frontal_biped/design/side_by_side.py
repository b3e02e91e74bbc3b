"""Inverse dynamics of a robot at many states and its derivatives, by copies of it in one Pinocchio model.

One call speaks for all copies, which stand on the ground beside each other and do not feel it. The stance foot is at
rest and there is no gravity, so the ground's reaction is what the stance ankle passes on: its derivatives are those
that Pinocchio keeps of the force on what each joint carries, and the force itself follows from them, being linear in
the accelerations and quadratic in the velocities. What a motion's matrices say already is not asked again: the weight,
which is what a ground accelerated upwards by g would want, and the same robot set in motion from rest.
"""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY

COPIES = 16
"""Of the robot in one model; twice as many take as long for each."""

GROUND = slice(0, 3)  # rows F_h, F_v, N_0
JOINTS = slice(3, 7)  # rows u_1..u_4
_H, _V, _MOMENT = range(3)
_FORCE, _TURN = slice(0, 2), 5  # of a spatial force: h and v, and the moment out of the plane

LATER = np.maximum.outer(np.arange(4), np.arange(4))
"""(4, 4) the later of two joints: turning both, only its lever counts, for the earlier one turns all as a whole."""


class InverseDynamics(NamedTuple):
    """Without gravity, at n states; rows F_h, F_v, N_0, u_1..u_4.

    Attributes:
        tau: (n, 7).
        by_q: (n, 7, 4) derivative with respect to q.
        by_dq: (n, 7, 4) to dq.
        by_ddq: (n, 7, 4) to ddq.
        J: (n, 2, 4) velocity (h, v) of a point at the origin that moves with the swing foot.
    """

    tau: FloatArray
    by_q: FloatArray
    by_dq: FloatArray
    by_ddq: FloatArray
    J: FloatArray


class AtRest(NamedTuple):
    """Inverse dynamics of a robot that does not move yet, at n states, rows as in `InverseDynamics`.

    Attributes:
        tau: (n, 7).
        by_q: (n, 7, 4) derivative with respect to q.
    """

    tau: FloatArray
    by_q: FloatArray


def side_by_side(biped: FrontalBiped) -> "SideBySide":
    """The robot's copies, made once: that takes as long as several evaluations of a gait."""
    if biped not in _MADE:
        _MADE[biped] = SideBySide(biped)
    return _MADE[biped]


class SideBySide:
    """A robot's copies, and their work data; like the robot, not thread-safe.

    Args:
        biped: the robot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        one, self._model = biped.pinned, pin.Model()
        self._model.gravity.linear = np.zeros(3)
        for copy in range(COPIES):
            placed = [0]
            for joint in range(1, one.njoints):
                at = placed[one.parents[joint]], one.joints[joint], one.jointPlacements[joint]
                placed.append(self._model.addJoint(*at, f"{one.names[joint]} {copy}"))
                self._model.appendBodyToJoint(placed[-1], one.inertias[joint], pin.SE3.Identity())
        self._model.armature = np.tile(one.armature, COPIES)
        self._data = self._model.createData()
        resting = biped.inverse_dynamics(*np.zeros((3, 4)))
        self._weight, self._moment_of_foot = resting[_V], resting[_MOMENT] - resting[3]
        # views of the results: reading them afresh costs as much as a call
        data = self._data
        self._torques = data.tau.reshape(COPIES, 4)
        self._of_joints = [_own_blocks(matrix) for matrix in (data.dtau_dq, data.dtau_dv, data.M)]
        self._of_ground = [_columns(matrix) for matrix in (data.dFdq, data.dFdv, data.dFda)]
        self._J = _columns(data.J)

    def at(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> InverseDynamics:
        """Inverse dynamics at n states, q, dq and ddq (n, 4)."""
        n, groups = len(q), -(-len(q) // COPIES)
        states = np.zeros((3, groups * COPIES, 4))
        states[:, :n] = q, dq, ddq
        torques, derivatives, J = (np.empty((groups, COPIES, *shape)) for shape in ((7,), (3, 7, 4), (2, 4)))
        for group, state in enumerate(states.reshape(3, groups, -1).transpose(1, 0, 2)):
            pin.computeRNEADerivatives(self._model, self._data, *state)
            torques[group, :, JOINTS], J[group] = self._torques, self._J[:, :2]
            for part in range(3):
                derivatives[group, :, part, JOINTS] = self._of_joints[part]
                derivatives[group, :, part, _FORCE] = self._of_ground[part][:, _FORCE]
                derivatives[group, :, part, _MOMENT] = self._of_ground[part][:, _TURN]
        by_q, by_dq, by_ddq = derivatives.reshape(-1, 3, 7, 4)[:n].transpose(1, 0, 2, 3)
        tau = torques.reshape(-1, 7)[:n]
        push = by_ddq[:, GROUND] @ ddq[:, :, None] + 0.5 * by_dq[:, GROUND] @ dq[:, :, None]
        tau[:, GROUND] = push[:, :, 0]
        return InverseDynamics(tau, by_q, by_dq, by_ddq, J.reshape(-1, 2, 4)[:n])

    def weight(self, by_ddq: FloatArray) -> AtRest:
        """The weight alone at the states that ``by_ddq`` (n, 7, 4) of `InverseDynamics` belongs to.

        Turning joint j moves the centre of mass of what it carries by a quarter turn of its lever: the moment about the
        ground point changes by the horizontal way times the weight, the torque about joint i by that of the later of i
        and j.
        """
        n = len(by_ddq)
        tau, by_q = np.zeros((n, 7)), np.zeros((n, 7, 4))
        ways = GRAVITY * by_ddq[:, _H]
        tau[:, JOINTS] = GRAVITY * by_ddq[:, _V]
        tau[:, _V], tau[:, _MOMENT] = self._weight, tau[:, 3] + self._moment_of_foot
        by_q[:, _MOMENT], by_q[:, JOINTS] = ways, ways[:, LATER]
        return AtRest(tau, by_q)

    def from_rest(self, motion: InverseDynamics, dq: FloatArray) -> AtRest:
        """M dq: what the robot wants that is accelerated by a motion's own velocities dq (n, 4) from rest.

        In the plane, as complex numbers h + i v, turning joint k moves the place c of a mass m that it carries by
        i (c - p_k), and its velocity c' by i (c - p_k)'. Moments about joint i, not after k, and their derivatives are

            here           Im sum m conj(c - p_i) c'       Re sum m conj(c - p_i) (c - p_k)' - m conj(c - p_k) c'
            in motion      Im sum m conj(c - p_i) c''      by q', Re 2 sum m conj(c - p_i) (c - p_k)'

        so that half of what the motion has by its velocities is too much by  Re sum m conj(c - p_k) c', whatever i is;
        M being symmetric, it is the later joint's for i after k too. Where i is k, the derivative here is but
        -Re conj(sum m (c - p_k)) p_k', which tells the sum. The force, sum m c', has half exactly.
        """
        tau = (motion.by_ddq @ dq[:, :, None])[:, :, 0]
        by_q = 0.5 * motion.by_dq
        velocity = np.cumsum(motion.J * dq[:, None], axis=2) - motion.J * np.cumsum(dq, axis=1)[:, None]  # of joints
        about_itself = motion.by_ddq[:, _H] * velocity[:, 1] - motion.by_ddq[:, _V] * velocity[:, 0]
        excess = np.diagonal(by_q[:, JOINTS], axis1=1, axis2=2) - about_itself
        by_q[:, _MOMENT] -= excess
        by_q[:, JOINTS] -= excess[:, LATER]
        return AtRest(tau, by_q)


_MADE: WeakKeyDictionary[FrontalBiped, SideBySide] = WeakKeyDictionary()


def _own_blocks(matrix: FloatArray) -> FloatArray:
    """(copies, 4, 4) what belongs to one copy alone."""
    return np.einsum("iaib->iab", matrix.reshape(COPIES, 4, COPIES, 4))


def _columns(matrix: FloatArray) -> FloatArray:
    """(copies, 6, 4) columns of the copies' joints."""
    return matrix.reshape(6, COPIES, 4).transpose(1, 0, 2)
