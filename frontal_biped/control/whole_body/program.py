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
from frontal_biped.control.whole_body.limits import CONTACT, LOADED, UNLIMITED, Bounds, MotionLimits, contact_rows
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import NOTHING, WholeBodySolution, WholeBodyTargets
from frontal_biped.control.whole_body.tasks import (
    COP,
    FRI,
    LEGS,
    NATURE,
    WRENCH,
    Rows,
    TaskRows,
    weights,
)
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

ACCELERATION = 100.0
"""Unit of accelerations in the program's rows [rad/s^2]: one absolute tolerance fits all."""

ACCURACY, ITERATIONS, INNER = 1e-8, 30, 60

STANDING = 1e3
"""Weight of the foot's standing where it is a target, against that of the outputs [-]."""

GIVEN_WAY = "joint ranges and speeds, standing foot"
HELD = "everything: the last torques are held"


class WholeBodyProgram:
    """Torques of every joint at a state.

    Args:
        free: the robot.
        settings: gains, limits and weights.

    Attributes:
        counts: ticks by how they were answered: by the linear system, by the program, by the program with limits that
            gave way, by the last answer held.
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings) -> None:
        self.free, self.settings = free, settings
        self.rows = TaskRows(free, settings)
        n = len(free.joint_names)
        self._n, self._nv = n, BASE + n
        size = self._nv + WRENCH
        # accelerations in rad/s^2, forces in weights, moments in weights times a tenth of a metre
        self._scale = np.ones(size)
        self._scale[self._nv :] = free.weight
        self._scale[self._nv + 3 :] *= 0.1
        self._effort = settings.torque_share * np.minimum(free.limits.effort, UNLIMITED)
        self._motion = MotionLimits(free, settings)
        self._contact = {side: contact_rows(free, side, settings) for side in Stance}
        self._floor = np.zeros(CONTACT)
        self._floor[LOADED] = settings.min_normal_force * free.weight

        # of the linear system: joints outside the legs are given, one row each
        self._outside = BASE + self.rows.outside
        self._core = np.setdiff1d(np.arange(size), self._outside)
        self._K = np.zeros((NATURE + LEGS, len(self._core)))
        self._x = np.zeros(size)
        self._square = len(self._core) == NATURE + LEGS

        k = CONTACT + 2 * n
        self._C = np.zeros((k, size))
        self._l, self._u = np.zeros(k), np.full(k, UNBOUNDED)
        self._torque_rows, self._motion_rows = slice(CONTACT, CONTACT + n), slice(CONTACT + n, k)
        self._C[self._motion_rows, BASE : self._nv] = np.eye(n) / ACCELERATION
        self._weight = weights(self.rows, settings)
        self._weight[[FRI, COP]] /= free.weight * 0.01  # of a moment, in the weight times a centimetre
        self._A = np.zeros((NATURE + LEGS + len(self._outside), size))
        self._solver = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self._relaxed = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self.reset()

    def reset(self) -> None:
        """Forget what was solved before."""
        self._last = NOTHING
        self.counts = {"linear": 0, "program": 0, "relaxed": 0, "held": 0}

    def solve(self, state: SpaceState, targets: WholeBodyTargets) -> WholeBodySolution:
        """The torques at a state."""
        rows = self.rows.write(state, targets)
        bounds = self._motion.at(state)
        solution = self._linear(rows, state, targets.stance, bounds)
        if solution is None:
            solution = self._programmed(rows, state, targets.stance, bounds)
        self._last = solution
        return solution

    # ------------------------------------------------------------------ no limit active
    def _linear(self, rows: Rows, state: SpaceState, stance: Stance, bounds: Bounds) -> WholeBodySolution | None:
        """The solution of the rows alone, if it keeps every limit."""
        if not self._square:
            return None
        x, core, count = self._x, self._core, NATURE + LEGS
        x[self._outside] = rows.b[count:]
        np.take(rows.A[:count], core, axis=1, out=self._K, mode="clip")
        given = rows.A[:count, self._outside] @ rows.b[count:]
        _, _, solved, singular = dgesv(self._K, rows.b[:count] - given)
        if singular:
            return None
        x[core] = solved
        dv, w = x[: self._nv].copy(), x[self._nv :].copy()
        tau = self._torques(state, stance, dv, w)
        joints = dv[BASE:]
        kept = (
            (np.abs(tau) <= self._effort).all()
            and (self._contact[stance] @ w >= self._floor).all()
            and (joints <= bounds.upper).all()
            and (joints >= bounds.lower).all()
        )
        if not kept:
            return None
        self.counts["linear"] += 1
        return WholeBodySolution(tau, dv, w, True)

    def _torques(self, state: SpaceState, stance: Stance, dv: FloatArray, w: FloatArray) -> FloatArray:
        tau: FloatArray = state.M[BASE:] @ dv
        tau += state.bias[BASE:]
        tau -= w @ state.feet[stance].J[:, BASE:]
        return tau

    # ------------------------------------------------------------------ limits active
    def pose(self, rows: Rows, state: SpaceState, stance: Stance, bounds: Bounds) -> QuadraticProgram:
        """The program in scaled variables; its arrays are overwritten by the next call."""
        nv, scale, A = self._nv, self._scale, self._A
        np.multiply(rows.A, scale, out=A)
        T, t = A[NATURE:] * self._weight[:, None], rows.b[NATURE:] * self._weight
        nature, b = A[:NATURE], rows.b[:NATURE].copy()
        nature[:BASE] /= self.free.weight
        b[:BASE] /= self.free.weight
        nature[BASE:] /= ACCELERATION
        b[BASE:] /= ACCELERATION
        C, l, u, effort = self._C, self._l, self._u, self._effort
        J, h = state.feet[stance].J[:, BASE:], state.bias[BASE:]
        C[:CONTACT, nv:] = self._contact[stance] * (scale[nv:] / self.free.weight)
        l[:CONTACT] = self._floor / self.free.weight
        torque, motion = self._torque_rows, self._motion_rows
        np.divide(state.M[BASE:], effort[:, None], out=C[torque, :nv])
        C[torque, nv:] = -J.T * scale[nv:] / effort[:, None]
        l[torque], u[torque] = -1.0 - h / effort, 1.0 - h / effort
        np.clip(bounds.lower / ACCELERATION, -UNBOUNDED, UNBOUNDED, out=l[motion])
        np.clip(bounds.upper / ACCELERATION, -UNBOUNDED, UNBOUNDED, out=u[motion])
        H, g = T.T @ T, -(t @ T)
        return QuadraticProgram(H, g, nature, b, C, l, u)

    def _programmed(self, rows: Rows, state: SpaceState, stance: Stance, bounds: Bounds) -> WholeBodySolution:
        qp = self.pose(rows, state, stance, bounds)
        answer = self._solver.solve(qp)
        if answer.solved:
            self.counts["program"] += 1
            return self._solution(answer.x, state, stance, True, "")
        qp = self.relaxed(qp)
        answer = self._relaxed.solve(qp)
        if answer.solved:
            self.counts["relaxed"] += 1
            return self._solution(answer.x, state, stance, False, GIVEN_WAY)
        self.counts["held"] += 1
        tau = self._last.tau if len(self._last.tau) else np.zeros(self._n)
        return WholeBodySolution(tau, np.zeros(self._nv), self._last.wrench, False, HELD)

    def relaxed(self, qp: QuadraticProgram) -> QuadraticProgram:
        """The same without the joints' motion, and the foot's standing a target: it always has a solution."""
        k = self._motion_rows.start
        S, s = STANDING * qp.A[BASE:], STANDING * qp.b[BASE:]
        return QuadraticProgram(qp.H + S.T @ S, qp.g - s @ S, qp.A[:BASE], qp.b[:BASE], qp.C[:k], qp.l[:k], qp.u[:k])

    def _solution(
        self, scaled: FloatArray, state: SpaceState, stance: Stance, solved: bool, given_way: str
    ) -> WholeBodySolution:
        x = scaled * self._scale
        dv, w = x[: self._nv], x[self._nv :]
        tau = self._torques(state, stance, dv, w)
        return WholeBodySolution(np.clip(tau, -self._effort, self._effort), dv, w, solved, given_way)
