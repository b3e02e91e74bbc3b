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

_EACH = np.arange(4)
_UP_TO = np.tril(np.ones((4, 4)))  # sums over joints

LATER = np.maximum.outer(np.arange(4), np.arange(4))
"""(4, 4) the later of two joints: turning both, only its lever counts, for the earlier one turns all as a whole."""


class InverseDynamics(NamedTuple):
    """Without gravity, at n states; rows F_h, F_v, N_0, u_1..u_4.

    Attributes:
        tau: (7, n).
        by: (3, 4, 7, n) derivatives with respect to q, dq and ddq of each joint.
        J: (4, 2, n) of each joint, the velocity (h, v) of a point at the origin that moves with the swing foot.
    """

    tau: FloatArray
    by: FloatArray
    J: FloatArray


class AtRest(NamedTuple):
    """Inverse dynamics of a robot that does not move yet, at n states, rows as in `InverseDynamics`.

    Attributes:
        tau: (7, n).
        by_q: (4, 7, n) derivative with respect to q of each joint.
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
        self._torques = data.tau.reshape(COPIES, 4).T
        self._of_joints = [_own_blocks(matrix) for matrix in (data.dtau_dq, data.dtau_dv, data.M)]
        self._of_ground = [_columns(matrix) for matrix in (data.dFdq, data.dFdv, data.dFda)]
        self._J = _columns(data.J)

    def at(self, states: FloatArray) -> InverseDynamics:
        """Inverse dynamics at n states, q, dq and ddq (3, n, 4)."""
        n, groups = states.shape[1], -(-states.shape[1] // COPIES)
        if n < groups * COPIES:
            states = np.concatenate([states, np.zeros((3, groups * COPIES - n, 4))], axis=1)
        tau, J = np.empty((7, groups, COPIES)), np.empty((4, 2, groups, COPIES))
        by = np.empty((3, 4, 7, groups, COPIES))
        for group, state in enumerate(states.reshape(3, groups, -1).swapaxes(0, 1)):
            pin.computeRNEADerivatives(self._model, self._data, *state)
            tau[JOINTS, group], J[:, :, group] = self._torques, self._J[:, :2]
            for of_part, joints, ground in zip(by[:, :, :, group], self._of_joints, self._of_ground, strict=True):
                of_part[:, JOINTS] = joints
                of_part[:, _FORCE] = ground[:, _FORCE]
                of_part[:, _MOMENT] = ground[:, _TURN]
        tau, by, J = (part.reshape(*part.shape[:-2], -1)[..., :n] for part in (tau, by, J))
        _, dq, ddq = states[:, :n].swapaxes(1, 2).copy()[:, :, None]
        pushed = by[2, :, GROUND] * ddq
        pushed += by[1, :, GROUND] * (0.5 * dq)
        np.add.reduce(pushed, axis=0, out=tau[GROUND])
        return InverseDynamics(tau, by, J)

    def weight(self, by_ddq: FloatArray) -> AtRest:
        """The weight alone at the states that ``by_ddq`` (4, 7, n) of `InverseDynamics` belongs to.

        Turning joint j moves the centre of mass of what it carries by a quarter turn of its lever: the moment about the
        ground point changes by the horizontal way times the weight, the torque about joint i by that of the later of i
        and j.
        """
        ways = GRAVITY * by_ddq[:, _H]
        tau, by_q = np.zeros(by_ddq.shape[1:]), np.zeros(by_ddq.shape)
        np.multiply(GRAVITY, by_ddq[:, _V], out=tau[JOINTS])
        tau[_V] = self._weight
        np.add(tau[3], self._moment_of_foot, out=tau[_MOMENT])
        by_q[:, _MOMENT], by_q[:, JOINTS] = ways, ways[LATER]
        return AtRest(tau, by_q)

    def from_rest(self, motion: InverseDynamics, dq: FloatArray) -> AtRest:
        """M dq: what the robot wants that is accelerated by a motion's own velocities dq (4, n) from rest.

        In the plane, as complex numbers h + i v, turning joint k moves the place c of a mass m that it carries by
        i (c - p_k), and its velocity c' by i (c - p_k)'. Moments about joint i, not after k, and their derivatives are

            here           Im sum m conj(c - p_i) c'       Re sum m conj(c - p_i) (c - p_k)' - m conj(c - p_k) c'
            in motion      Im sum m conj(c - p_i) c''      by q', Re 2 sum m conj(c - p_i) (c - p_k)'

        so that half of what the motion has by its velocities is too much by  Re sum m conj(c - p_k) c', whatever i is;
        M being symmetric, it is the later joint's for i after k too. Where i is k, the derivative here is but
        -Re conj(sum m (c - p_k)) p_k', which tells the sum. The force, sum m c', has half exactly.
        """
        _, by_dq, by_ddq = motion.by
        tau = np.add.reduce(by_ddq * dq[:, None], axis=0)
        by_q = 0.5 * by_dq
        of_all = (_UP_TO @ (motion.J * dq[:, None]).reshape(4, -1)).reshape(motion.J.shape)
        velocity = of_all - motion.J * (_UP_TO @ dq)[:, None]  # of joints
        about_itself = by_ddq[:, _H] * velocity[:, 1] - by_ddq[:, _V] * velocity[:, 0]
        excess = by_q[_EACH, 3 + _EACH] - about_itself
        by_q[:, _MOMENT] -= excess
        by_q[:, JOINTS] -= excess[LATER]
        return AtRest(tau, by_q)


_MADE: WeakKeyDictionary[FrontalBiped, SideBySide] = WeakKeyDictionary()


def _own_blocks(matrix: FloatArray) -> FloatArray:
    """(4, 4, copies) what belongs to one copy alone: to each of its joints, the rows."""
    return np.einsum("iaib->bai", matrix.reshape(COPIES, 4, COPIES, 4))


def _columns(matrix: FloatArray) -> FloatArray:
    """(4, 6, copies) columns of the copies' joints."""
    return matrix.reshape(6, COPIES, 4).transpose(2, 0, 1)
