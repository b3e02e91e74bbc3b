r"""The whole-body program: the linear system while no limit is active, ProxQP where one is.

    minimise    1/2 |W (T x - t)|^2
    subject to  base dynamics, stance foot at rest
                |tau| <= tau_max,   tau = M_j dv + h_j - J_j' w
                |F_x|, |F_y| <= mu/sqrt(2) F_z,   F_z >= F_min
                centre of pressure inside the sole, yaw moment inside what friction holds there
                accelerations that keep every joint inside its range and speed

Joints outside the legs give way first, then the swing foot and the pelvis, then the lengths and the centre of pressure,
last the paper's outputs. Where nothing keeps all limits, ranges and speeds give way, then the standing foot: torque
limits and what the contact can carry are never asked to.
"""

import numpy as np
from scipy.linalg.lapack import dgesv

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import NOTHING, WholeBodySolution, WholeBodyTargets
from frontal_biped.control.whole_body.tasks import (
    COP,
    FOOT,
    FRI,
    LEGS,
    LENGTHS,
    NATURE,
    OUTPUTS,
    PELVIS,
    SWING,
    WRENCH,
    TaskRows,
)
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

CONTACT = 11
KEPT = 1e-9


class WholeBodyProgram:
    """Torques of every joint at a state.

    Args:
        free: the robot.
        settings: gains, limits and weights.
        period: time for which torques act [s].
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings, period: float = 1e-3) -> None:
        self.free, self.settings, self.period = free, settings, period
        self.rows = TaskRows(free, settings)
        n = len(free.joint_names)
        self._n, self._nv = n, BASE + n
        size = self._nv + WRENCH
        self._scale = np.ones(size)
        self._scale[self._nv :] = free.weight
        self._scale[self._nv + 3 :] *= 0.1
        limits = free.limits
        effort = np.where(np.isfinite(limits.effort), limits.effort, UNBOUNDED)
        self._effort = settings.torque_share * effort
        self._contact = {side: self._contact_rows(side) for side in Stance}
        k = CONTACT + 2 * n
        self._C = np.zeros((k, size))
        self._l, self._u = np.zeros(k), np.full(k, UNBOUNDED)
        self._torque = slice(CONTACT, CONTACT + n)
        self._motion = slice(CONTACT + n, k)
        self._C[self._motion, BASE : self._nv] = np.eye(n)
        tasks = LEGS + len(self.rows.outside)
        weight = np.full(tasks, 0.01)
        weight[OUTPUTS], weight[FRI], weight[COP], weight[LENGTHS] = 1.0, 1.0, 0.5, 1.0
        weight[PELVIS], weight[SWING], weight[FOOT] = 0.3, 0.3, 0.3
        self._weight = weight
        self._solver = ProxQpSolver(accuracy=1e-8, max_iterations=100)
        self._relaxed = ProxQpSolver(accuracy=1e-6, max_iterations=100)
        self.reset()

    def reset(self) -> None:
        """Forget what was solved before."""
        self._last = NOTHING
        self.counts = {"linear": 0, "program": 0, "relaxed": 0, "held": 0}

    def _contact_rows(self, side: Stance) -> FloatArray:
        """(11, 6) rows, times the wrench at least zero."""
        s = self.settings
        left, right = self.free.soles
        sole = left if side is Stance.LEFT else right
        front, back = s.sole_share * sole.front, s.sole_share * sole.back
        out, inn = s.sole_share * sole.outer, s.sole_share * sole.inner
        low, high = (-inn, out) if side is Stance.LEFT else (-out, inn)
        mu = s.friction / np.sqrt(2.0)
        # a quarter of the contact patch's length and width is the mean arm of friction; the rest is spent on the CoP
        arm = 0.5 * s.friction * 0.5 * (sole.length + sole.width) * 0.5
        C = np.zeros((CONTACT, WRENCH))
        for i, axis in enumerate((0, 1)):
            C[2 * i, [axis, 2]] = 1.0, mu
            C[2 * i + 1, [axis, 2]] = -1.0, mu
        C[4, [3, 2]] = 1.0, -low  # y F_z = M_x
        C[5, [3, 2]] = -1.0, high
        C[6, [4, 2]] = 1.0, front  # -x F_z = M_y
        C[7, [4, 2]] = -1.0, back
        C[8, [5, 2]] = 1.0, arm
        C[9, [5, 2]] = -1.0, arm
        C[10, 2] = 1.0
        return C

    def solve(self, state: SpaceState, targets: WholeBodyTargets) -> WholeBodySolution:
        """The torques at a state."""
        n, nv = self._n, self._nv
        rows = self.rows.write(state, targets)
        foot = state.feet[targets.stance]
        M, h, J = state.M[BASE:], state.bias[BASE:], foot.J[:, BASE:]
        low, high = self._motion_limits(state)
        contact = self._contact[targets.stance]
        floor = np.zeros(CONTACT)
        floor[10] = self.settings.min_normal_force * self.free.weight
        square = rows.A.shape[0] == rows.A.shape[1]
        if square:
            _, _, x, singular = dgesv(rows.A, rows.b)
            if not singular:
                dv, w = x[:nv], x[nv:]
                tau = M @ dv + h - J.T @ w
                if (
                    np.all(np.abs(tau) <= self._effort)
                    and np.all(contact @ w >= floor)
                    and np.all(dv[BASE:] <= high)
                    and np.all(dv[BASE:] >= low)
                ):
                    self.counts["linear"] += 1
                    self._last = WholeBodySolution(tau, dv, w, True)
                    return self._last
        scale = self._scale
        A = rows.A * scale
        T, t = A[NATURE:] * self._weight[:, None], rows.b[NATURE:] * self._weight
        # rows of forces in units of the weight
        unit = 1.0 / self.free.weight
        T[[FRI, COP]] *= 10.0 * unit * 10.0
        C, l, u = self._C, self._l, self._u
        C[:CONTACT, nv:] = contact * scale[nv:] * unit
        l[:CONTACT] = floor * unit
        span = np.minimum(self._effort, 1e6)
        C[self._torque, :nv] = M / span[:, None]
        C[self._torque, nv:] = -J.T * scale[nv:] / span[:, None]
        l[self._torque] = (-self._effort - h) / span
        u[self._torque] = (self._effort - h) / span
        C[self._motion, BASE:nv] = np.eye(n) * 0.01
        l[self._motion], u[self._motion] = np.maximum(low * 0.01, -UNBOUNDED), np.minimum(high * 0.01, UNBOUNDED)
        nature = A[:NATURE].copy()
        b = rows.b[:NATURE].copy()
        nature[:BASE] *= unit
        b[:BASE] *= unit
        H, g = T.T @ T, -(t @ T)
        H[np.diag_indices(len(H))] += 1e-8
        qp = QuadraticProgram(H, g, nature, b, C, l, u)
        answer = self._solver.solve(qp)
        if answer.solved:
            self.counts["program"] += 1
            self._last = self._solution(answer.x * scale, M, h, J, True, "")
            return self._last
        # the standing foot and the joints' motion give way
        heavy = 30.0
        S, s = A[BASE:NATURE] * heavy, rows.b[BASE:NATURE] * heavy
        H, g = H + S.T @ S, g - s @ S
        k = self._motion.start
        qp = QuadraticProgram(H, g, nature[:BASE], b[:BASE], C[:k], l[:k], u[:k])
        answer = self._relaxed.solve(qp)
        if np.all(np.isfinite(answer.x)) and answer.solved:
            self.counts["relaxed"] += 1
            self._last = self._solution(answer.x * scale, M, h, J, False, "joint ranges and speeds, standing foot")
            return self._last
        self.counts["held"] += 1
        return self._last

    def _solution(
        self, x: FloatArray, M: FloatArray, h: FloatArray, J: FloatArray, solved: bool, given: str
    ) -> WholeBodySolution:
        dv, w = x[: self._nv], x[self._nv :]
        tau = M @ dv + h - J.T @ w
        return WholeBodySolution(np.clip(tau, -self._effort, self._effort), dv, w, solved, given)

    def _motion_limits(self, state: SpaceState) -> tuple[FloatArray, FloatArray]:
        """Accelerations (n,) that keep ranges and speeds."""
        s, limits = self.settings, self.free.limits
        q, v = state.q[BASE + 1 :], state.v[BASE:]
        rate = 30.0  # limits are approached no faster than at this rate [1/s]
        speed = s.speed_share * limits.velocity
        high = rate * (speed - v)
        low = rate * (-speed - v)
        # second-order barrier: dv >= -(a + b) v - a b (q - lower)
        high = np.minimum(high, rate**2 * (limits.upper - s.range_margin - q) - 2.0 * rate * v)
        low = np.maximum(low, rate**2 * (limits.lower + s.range_margin - q) - 2.0 * rate * v)
        return np.minimum(low, high), np.maximum(low, high)
