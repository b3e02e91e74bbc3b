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
    """At n states; rows F_h, F_v, N_0, u_1..u_4. They are views of arrays that the caller has.

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

    def at(self, states: FloatArray, found: FloatArray) -> FloatArray:
        """Inverse dynamics without gravity at n states.

        Args:
            states: (3, 4, n) q, dq and ddq.
            found: (13, 7, n) filled with values, then derivatives with respect to q, dq and ddq of each joint; rows
                F_h, F_v, N_0, u_1..u_4.

        Returns:
            (4, 2, n) of each joint, the velocity (h, v) of a point at the origin that moves with the swing foot.
        """
        n = states.shape[2]
        tau, by, J = found[0], found[1:].reshape(3, 4, 7, n), np.empty((4, 2, n))
        one = np.zeros((3, COPIES, 4))
        for begin in range(0, n, COPIES):
            here = slice(begin, min(begin + COPIES, n))
            k = here.stop - begin
            one[:, :k] = states[:, :, here].swapaxes(1, 2)
            pin.computeRNEADerivatives(self._model, self._data, *one.reshape(3, -1))
            tau[JOINTS, here], J[:, :, here] = self._torques[:, :k], self._J[:, :2, :k]
            for of_part, joints, ground in zip(by[..., here], self._of_joints, self._of_ground, strict=True):
                of_part[:, JOINTS] = joints[..., :k]
                of_part[:, _FORCE] = ground[:, _FORCE, :k]
                of_part[:, _MOMENT] = ground[:, _TURN, :k]
        _, dq, ddq = states[:, :, None]
        pushed = by[2, :, GROUND] * ddq
        pushed += by[1, :, GROUND] * (0.5 * dq)
        np.add.reduce(pushed, axis=0, out=tau[GROUND])
        return J

    def weight(self, by_ddq: FloatArray, found: InverseDynamics) -> None:
        """The weight alone at the states that ``by_ddq`` (4, 7, n) of `at` belongs to.

        Turning joint j moves the centre of mass of what it carries by a quarter turn of its lever: the moment about the
        ground point changes by the horizontal way times the weight, the torque about joint i by that of the later of i
        and j.

        Args:
            by_ddq: derivatives with respect to ddq.
            found: filled, but for what is zero in it: derivatives of the force.
        """
        tau, by_q = found
        ways = np.multiply(GRAVITY, by_ddq[:, _H], out=by_q[:, _MOMENT])
        by_q[:, JOINTS] = ways[LATER]
        np.multiply(GRAVITY, by_ddq[:, _V], out=tau[JOINTS])
        tau[_V] = self._weight
        np.add(tau[3], self._moment_of_foot, out=tau[_MOMENT])

    def from_rest(self, moving: FloatArray, J: FloatArray, dq: FloatArray, found: InverseDynamics) -> None:
        """M dq: what the robot wants that is accelerated by a motion's own velocities from rest.

        In the plane, as complex numbers h + i v, turning joint k moves the place c of a mass m that it carries by
        i (c - p_k), and its velocity c' by i (c - p_k)'. Moments about joint i, not after k, and their derivatives are

            here           Im sum m conj(c - p_i) c'       Re sum m conj(c - p_i) (c - p_k)' - m conj(c - p_k) c'
            in motion      Im sum m conj(c - p_i) c''      by q', Re 2 sum m conj(c - p_i) (c - p_k)'

        so that half of what the motion has by its velocities is too much by  Re sum m conj(c - p_k) c', whatever i is;
        M being symmetric, it is the later joint's for i after k too. Where i is k, the derivative here is but
        -Re conj(sum m (c - p_k)) p_k', which tells the sum. The force, sum m c', has half exactly.

        Args:
            moving: (13, 7, n) inverse dynamics of the motion.
            J: (4, 2, n) that `at` has returned for it.
            dq: (4, n) its velocities.
            found: filled.
        """
        (tau, by_q), by_dq, by_ddq = found, moving[5:9], moving[9:]
        np.add.reduce(by_ddq * dq[:, None], axis=0, out=tau)
        np.multiply(0.5, by_dq, out=by_q)
        velocity = (_UP_TO @ (J * dq[:, None]).reshape(4, -1)).reshape(J.shape)  # of joints
        velocity -= J * (_UP_TO @ dq)[:, None]
        excess = by_ddq[:, _V] * velocity[:, 0] - by_ddq[:, _H] * velocity[:, 1]
        excess += by_q[_EACH, 3 + _EACH]
        by_q[:, _MOMENT] -= excess
        by_q[:, JOINTS] -= excess[LATER]


_MADE: WeakKeyDictionary[FrontalBiped, SideBySide] = WeakKeyDictionary()


def _own_blocks(matrix: FloatArray) -> FloatArray:
    """(4, 4, copies) what belongs to one copy alone: to each of its joints, the rows."""
    return np.einsum("iaib->bai", matrix.reshape(COPIES, 4, COPIES, 4))


def _columns(matrix: FloatArray) -> FloatArray:
    """(4, 6, copies) columns of the copies' joints."""
    return matrix.reshape(6, COPIES, 4).transpose(2, 0, 1)
