r"""The whole-body program: torques of every joint.

    minimise    1/2 |W (T x - t)|^2
    subject to  base dynamics, stance foot at rest
                |tau| <= tau_max,   tau = M_j dv + h_j - J_j' w
                |F_x|, |F_y| <= mu/sqrt(2) F_z,   F_z >= F_min
                centre of pressure inside the sole, yaw moment inside what friction holds there
                accelerations that keep every joint inside its range and speed

There are as many targets as freedoms: while no limit is active the solution is that of a linear system, and where some
are, the nearest point of a polyhedron (`nearest`), in the same coordinates. ProxQP solves the same program where that
is asked for (`WholeBodySettings.solver`), or where rounding leaves the exact way undecided.

Joints outside the legs give way first, then the swing foot and the pelvis, then the lengths, the centre of pressure and
the paper's outputs. Where nothing keeps all limits, ranges and speeds give way, then the standing foot: torque limits
and what the contact can carry are never asked to.
"""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.limits import CONTACT, LOADED, UNLIMITED, Bounds, MotionLimits, contact_rows
from frontal_biped.control.whole_body.motion import Motion, MotionSolver, SingularRowsError
from frontal_biped.control.whole_body.nearest import ACCELERATION, LimitRows
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import NOTHING, WholeBodySolution, WholeBodyTargets
from frontal_biped.control.whole_body.tasks import (
    COP,
    FRI,
    NATURE,
    WRENCH,
    Rows,
    TaskRows,
    weights,
)
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.least_distance import NoFeasiblePointError
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

ACCURACY, ITERATIONS, INNER = 1e-8, 30, 60

LEVER = 0.01
"""Of the weight, a moment that is worth as much as 1 rad/s^2 of an output [m]."""

STANDING = 1e3
"""Weight of the foot's standing where it is a target, against that of the outputs [-]."""

GIVEN_WAY = "joint ranges and speeds, standing foot"
HELD = "everything: the last torques are held"


class WholeBodyProgram:
    """Torques of every joint at a state.

    Args:
        free: the robot.
        settings: gains, limits and weights.
        rows: writes what the robot is asked for; None: the paper's outputs and the rest (`TaskRows`).

    Attributes:
        counts: ticks by how they were answered: by the linear system, by the nearest point with limits active, by
            ProxQP, with limits that gave way, by the last answer held.
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings, rows: TaskRows | None = None) -> None:
        self.free, self.settings = free, settings
        self.rows = rows or TaskRows(free, settings)
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

        worth = weights(self.rows)
        worth[[FRI, COP]] /= free.weight * LEVER
        self._weight = worth
        self._motions = MotionSolver(self.rows, worth, STANDING)
        self._limits = LimitRows(self._effort, free.weight)
        self._targets = len(worth)

        k = CONTACT + 2 * n
        self._C = np.zeros((k, size))
        self._l, self._u = np.zeros(k), np.full(k, UNBOUNDED)
        self._torque_rows, self._motion_rows = slice(CONTACT, CONTACT + n), slice(CONTACT + n, k)
        self._C[self._motion_rows, BASE : self._nv] = np.eye(n) / ACCELERATION
        self._A = np.zeros((NATURE + len(worth), size))
        self._solver = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self._relaxed = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self.reset()

    def reset(self) -> None:
        """Forget what was solved before."""
        self._last = NOTHING
        self.counts = dict.fromkeys(("linear", "limited", "program", "relaxed", "held"), 0)

    def solve(self, state: SpaceState, targets: WholeBodyTargets) -> WholeBodySolution:
        """The torques at a state."""
        stance = targets.stance
        rows, bounds = self.rows.write(state, targets), self._motion.at(state)
        solution = None
        if self.settings.solver == "exact":
            solution = self._exact(rows, state, stance, bounds)
        if solution is None:
            solution = self._programmed(rows, state, stance, bounds)
        self._last = solution
        return solution

    # ------------------------------------------------------------------ the exact way
    def _exact(self, rows: Rows, state: SpaceState, stance: Stance, bounds: Bounds) -> WholeBodySolution | None:
        """The solution; None where rounding leaves it undecided."""
        motions, contact = self._motions, self._contact[stance]
        try:
            motions.factorise(rows, state, stance)
            motion = motions.meeting_all()
            if self._kept(motion, contact, bounds):
                return self._answer("linear", motion)
            along = motions.missing()
        except SingularRowsError:
            return None
        asked = Motion(along.x[:, : self._targets], along.tau[:, : self._targets])
        for how, columns, kept in (("limited", asked, bounds), ("relaxed", along, None)):
            polyhedron = self._limits.at(motion, columns, contact, self._floor, kept)
            try:
                r, _ = polyhedron.nearest()
            except NoFeasiblePointError:
                continue
            return self._answer(how, Motion(motion.x + columns.x @ r, motion.tau + columns.tau @ r))
        return None

    def _kept(self, motion: Motion, contact: FloatArray, bounds: Bounds) -> bool:
        joints = motion.x[BASE : self._nv]
        return bool(
            (np.abs(motion.tau) <= self._effort).all()
            and (contact @ motion.x[self._nv :] >= self._floor).all()
            and (joints <= bounds.upper).all()
            and (joints >= bounds.lower).all()
        )

    def _answer(self, how: str, motion: Motion) -> WholeBodySolution:
        self.counts[how] += 1
        given_way = GIVEN_WAY if how == "relaxed" else ""
        tau = np.clip(motion.tau, -self._effort, self._effort)  # of rounding
        return WholeBodySolution(tau, motion.x[: self._nv], motion.x[self._nv :], not given_way, given_way)

    # ------------------------------------------------------------------ by ProxQP
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
        for how, solver in (("program", self._solver), ("relaxed", self._relaxed)):
            if how == "relaxed":
                qp = self.relaxed(qp)
            answer = solver.solve(qp)
            if answer.solved:
                x = answer.x * self._scale
                J = state.feet[stance].J[:, BASE:]
                tau = state.M[BASE:] @ x[: self._nv] + state.bias[BASE:] - x[self._nv :] @ J
                return self._answer(how, Motion(x, tau))
        self.counts["held"] += 1
        tau = self._last.tau if len(self._last.tau) else np.zeros(self._n)
        return WholeBodySolution(tau, np.zeros(self._nv), self._last.wrench, False, HELD)

    def relaxed(self, qp: QuadraticProgram) -> QuadraticProgram:
        """The same without the joints' motion, and the foot's standing a target: it always has a solution."""
        k = self._motion_rows.start
        S, s = STANDING * ACCELERATION * qp.A[BASE:], STANDING * ACCELERATION * qp.b[BASE:]
        return QuadraticProgram(qp.H + S.T @ S, qp.g - s @ S, qp.A[:BASE], qp.b[:BASE], qp.C[:k], qp.l[:k], qp.u[:k])
