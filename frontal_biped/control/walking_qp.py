"""The controller's quadratic program: input-output linearisation under torque, contact and foot limits.

Decision variables x = (ddq (4), u (4), F_h, F_v).

    minimise    1/2 |(ddy - v) / a_0|^2 + 1/2 |(N_0 - p_FRI^d F_v) / T_0|^2
    subject to  D ddq + C dq + G = u                       dynamics of the pinned robot
                F = m (a_cm + (0, g))                      ground reaction
                |u| <= u_max                               torque limits
                F_v >= F_min                               unilateral contact
                |F_h| <= mu F_v                            friction cone
                outer F_v <= N_0 <= inner F_v              FRI inside the sole

ddy = ddq_b - h_d' ddbeta - h_d'' dbeta^2 is the acceleration of the output y = q_b - h_d(beta), v the one asked for,
and N_0 = u_1 - armature ddq_1 - h_a F_h + m_f g c_f the moment of the ground reaction about the ground below the
ankle. Four targets meet four freedoms: while no limit is active both costs vanish, the solution is the input-output
linearising torque with the FRI on its target, and the weights a_0 and T_0 do not matter. Inside the program u and F
are in units of T_0 and m g, and every row likewise, so that one absolute tolerance fits all.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin
from scipy.linalg.lapack import dgesv

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.frontal_chain import GRAVITY
from frontal_biped.quadratic_program import UNBOUNDED, QuadraticProgram

VARIABLES = 10
OUTPUT_ACCELERATION = 10.0  # a_0 [rad/s^2]
TORQUE_LEVER = 0.1  # T_0 = m g times this [m], of the order of a sole
DDQ, U, FORCE = slice(0, 4), slice(4, 8), slice(8, 10)


class ContactLimits(NamedTuple):
    """Limits the controller keeps.

    Attributes:
        friction: coefficient of friction [-].
        min_normal_force: smallest normal force [N].
        fri_outer: outermost FRI [m], negative.
        fri_inner: innermost FRI [m].
        max_torque: (4,) [N m].
    """

    friction: float
    min_normal_force: float
    fri_outer: float
    fri_inner: float
    max_torque: FloatArray


class Targets(NamedTuple):
    """What the controller asks of one instant.

    Attributes:
        h_d1: (3,) dh_d/dbeta [-].
        h_d2_dbeta2: (3,) h_d'' dbeta^2 [rad/s^2].
        ddy: (3,) wanted output acceleration v [rad/s^2].
        p_fri: wanted FRI [m].
    """

    h_d1: FloatArray
    h_d2_dbeta2: FloatArray
    ddy: FloatArray
    p_fri: float


class WalkingQp:
    """Builds the program at a state; matrices are allocated once and overwritten at every call.

    Args:
        biped: the robot.
        limits: to keep.
    """

    def __init__(self, biped: FrontalBiped, limits: ContactLimits) -> None:
        self.biped = biped
        self.limits = limits
        T_0, F_0 = TORQUE_LEVER * biped.weight, biped.weight
        self._T_0, self._F_0 = T_0, F_0
        self.scale = np.array([1.0] * 4 + [T_0] * 4 + [F_0] * 2)  # of the variables
        self._model = biped.floating
        self._data = biped.floating.createData()
        self._q, self._dq = np.zeros(BASE + 4), np.zeros(BASE + 4)
        # N_0 / T_0 = moment_row . x + moment_constant
        foot = biped.chain.bodies[0]
        moment_row = np.zeros(VARIABLES)
        moment_row[0] = -biped.chain.armature[0] / T_0
        moment_row[4] = 1.0
        moment_row[8] = -biped.ankle_height * F_0 / T_0
        moment_constant = foot.mass * GRAVITY * float(foot.com[0]) / T_0
        # outputs and FRI: residual = task x - goal
        self._task = np.zeros((4, VARIABLES))
        self._task[:3, 1:4] = np.eye(3) / OUTPUT_ACCELERATION
        self._task[3] = moment_row
        self._goal = np.zeros(4)
        self._goal[3] = -moment_constant
        # x = T ddq + t solves the equalities
        self._T, self._t = np.eye(VARIABLES, 4), np.zeros(VARIABLES)
        A = np.zeros((6, VARIABLES))
        A[:, 4:] = np.eye(6)
        C = np.zeros((9, VARIABLES))
        C[0, 8:], C[1, 8:] = (1.0, limits.friction), (-1.0, limits.friction)
        C[2], C[3] = moment_row, -moment_row
        C[2, 9] -= limits.fri_outer * F_0 / T_0
        C[3, 9] += limits.fri_inner * F_0 / T_0
        C[4, 9] = 1.0
        C[5:, U] = np.eye(4)
        torque = limits.max_torque / T_0
        l = np.concatenate([[0.0, 0.0, -moment_constant, moment_constant, limits.min_normal_force / F_0], -torque])
        u = np.concatenate([np.full(5, UNBOUNDED), torque])
        self.program = QuadraticProgram(np.zeros((VARIABLES, VARIABLES)), np.zeros(VARIABLES), A, np.zeros(6), C, l, u)

    def build(self, q: FloatArray, dq: FloatArray, targets: Targets) -> QuadraticProgram:
        """The program at the state q (4,) [rad], dq (4,) [rad/s]; its arrays are reused by the next call.

        Its solution times `scale` is (ddq, u, F_h, F_v) in SI units.
        """
        self._q[BASE:], self._dq[BASE:] = q, dq
        M = pin.crba(self._model, self._data, self._q)
        bias = pin.nonLinearEffects(self._model, self._data, self._q, self._dq)
        program, T, t = self.program, self._T, self._t
        np.divide(M[BASE:, BASE:], self._T_0, out=T[U])
        np.divide(M[:2, BASE:], self._F_0, out=T[FORCE])
        np.divide(bias[BASE:], self._T_0, out=t[U])
        np.divide(bias[:2], self._F_0, out=t[FORCE])
        np.negative(T[4:], out=program.A[:, DDQ])
        program.b[:] = t[4:]

        task, goal = self._task, self._goal
        np.divide(targets.h_d1, -OUTPUT_ACCELERATION, out=task[:3, 0])
        task[3, 9] = -targets.p_fri * self._F_0 / self._T_0
        np.divide(targets.ddy + targets.h_d2_dbeta2, OUTPUT_ACCELERATION, out=goal[:3])
        np.matmul(task.T, task, out=program.H)
        np.matmul(task.T, -goal, out=program.g)
        return program

    def unconstrained(self) -> FloatArray:
        """(10,) scaled x of the program just built without its inequalities: the closed-form linearising torque.

        Eliminating u and F leaves four equations for ddq, singular exactly where I_P = 0 (C03).
        """
        # LAPACK's solver itself: four unknowns do not repay the checks around it
        *_, ddq, singular = dgesv(self._task @ self._T, self._goal - self._task @ self._t)
        if singular:
            return np.zeros(VARIABLES)
        return self._T @ ddq + self._t
