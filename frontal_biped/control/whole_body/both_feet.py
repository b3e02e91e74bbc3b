r"""Torques of every joint while both feet stand: the whole-body program of double support.

Unknown are the accelerations dv of base and joints and the wrenches of both soles, x = (dv, w_l, w_r).

    minimise    1/2 |W (T x - t)|^2
    subject to  base dynamics, both feet at rest                       18 rows
                what either sole can carry, its force at least zero    as `limits` has it
                |tau| <= tau_max, accelerations inside the joints' ranges and speeds

Two feet at rest take twelve freedoms; six are left of the base, and T asks for them: the centre of mass forwards and
sideways, both lengths of the virtual legs (they are the height and the roll of the pelvis) and the pelvis' pitch and
yaw. Every joint outside the legs is held at its posture. That leaves six combinations of the wrenches that move
nothing: the load is shared as is asked, M_x, M_y, M_z of each sole and the difference of the forces along the ground
are kept small.

Where no limit is active the answer is that of the linear system of the equalities and T's gradient; otherwise ProxQP's.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.linalg.lapack import dgesv

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.limits import CONTACT, UNLIMITED, MotionLimits, contact_rows
from frontal_biped.control.whole_body.nearest import ACCELERATION
from frontal_biped.control.whole_body.settings import WholeBodySettings
from frontal_biped.control.whole_body.targets import KEPT, STRAIGHT, LegLength, WholeBodySolution, Yaw
from frontal_biped.control.whole_body.tasks import WRENCH, held, turned
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, SpaceState, X, Y, Z
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.quadratic_program import UNBOUNDED, ProxQpSolver, QuadraticProgram

STANDING = BASE + 2 * WRENCH
"""Rows of the base's dynamics and of both feet."""

COM, LENGTHS, PELVIS, OUTSIDE = slice(0, 2), slice(2, 4), slice(4, 6), 6
"""Asked-for rows: of the centre of mass, the legs' lengths, the pelvis; from there on the joints outside the legs."""

SHARED = 9
"""Asked-for rows of the wrenches: the share of the load, three moments a foot, two differences along the ground."""

WORTH_OF_WRENCHES = 0.1
"""Of a row of the wrenches, in weights and weights times a metre; that of the centre of mass, in m/s^2, is 1. A
centimetre of the centre of pressure moves it by a tenth of a m/s^2: it gives way by a ten thousandth of that [-]."""

ACCURACY, ITERATIONS, INNER = 1e-7, 30, 60
KEPT_TO = 1e-9
GIVEN_WAY = "joint ranges and speeds"
HELD = "everything: the last torques are held"


@dataclass(frozen=True)
class BothFeetTargets:
    """What is asked for while both feet stand, in the heading frame.

    Attributes:
        com_acceleration: (2,) of the centre of mass forwards and to the left [m/s^2].
        share: of the load on the left foot, 0 to 1 [-].
        joints: (n,) where every joint that is not in a leg is to be [rad].
        softness: 1 as the settings say; below, feedback of lengths and pelvis is reduced by this factor.
        left_length: of the left virtual leg.
        right_length: of the right virtual leg.
        pelvis_yaw: where the pelvis looks, from the heading.
    """

    com_acceleration: FloatArray
    share: float
    joints: FloatArray
    softness: float = 1.0
    left_length: LegLength = KEPT
    right_length: LegLength = KEPT
    pelvis_yaw: Yaw = STRAIGHT


@dataclass(frozen=True)
class BothFeetSolution(WholeBodySolution):
    """Answer of the program; ``wrench`` is that of the left sole.

    Attributes:
        other_wrench: (6,) on the right sole, as ``wrench``.
    """

    other_wrench: FloatArray = field(default_factory=lambda: np.zeros(WRENCH))


class BothFeetProgram:
    """Torques of every joint at a state in which both feet stand.

    Args:
        free: the robot.
        settings: gains and limits.
        outside: indices, among the joints, of those outside the legs (`TaskRows.outside`).

    Attributes:
        counts: ticks by how they were answered: by the linear system, by ProxQP, without ranges and speeds, by the
            last answer held.
    """

    def __init__(self, free: FreeRobot, settings: WholeBodySettings, outside: FloatArray) -> None:
        self.free, self.settings, self._outside = free, settings, outside
        n = len(free.joint_names)
        self._n, self._nv = n, BASE + n
        size = self._nv + 2 * WRENCH
        self._scale = np.ones(size)
        for first in (self._nv, self._nv + WRENCH):
            self._scale[first : first + 3] = free.weight
            self._scale[first + 3 : first + WRENCH] = 0.1 * free.weight
        self._wrenches = tuple(slice(first, first + WRENCH) for first in (self._nv, self._nv + WRENCH))
        self._effort = settings.torque_share * np.minimum(free.limits.effort, UNLIMITED)
        self._motion = MotionLimits(free, settings)
        rows = 2 * CONTACT + 2 * n
        self._C = np.zeros((rows, size))
        self._l, self._u = np.zeros(rows), np.full(rows, UNBOUNDED)
        for foot, side in enumerate(Stance):
            rows_of = slice(foot * CONTACT, (foot + 1) * CONTACT)
            contact = contact_rows(free, side, settings)
            self._C[rows_of, self._wrenches[foot]] = contact * (self._scale[self._wrenches[foot]] / free.weight)
        self._torque_rows = slice(2 * CONTACT, 2 * CONTACT + n)
        self._motion_rows = slice(2 * CONTACT + n, rows)
        self._C[self._motion_rows, BASE : self._nv] = np.eye(n) / ACCELERATION
        self._A, self._b = np.zeros((STANDING, size)), np.zeros(STANDING)
        asked = OUTSIDE + len(outside)
        self._T, self._t = np.zeros((asked + SHARED, size)), np.zeros(asked + SHARED)
        self._T[OUTSIDE + np.arange(len(outside)), BASE + outside] = 1.0
        worth = np.full(asked + SHARED, WORTH_OF_WRENCHES)
        worth[COM], worth[LENGTHS], worth[PELVIS], worth[OUTSIDE:asked] = 1.0, 1.0, 0.3, 0.01
        self._worth, self._asked = worth, asked
        self._share_wrenches()
        self._solver = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self._relaxed = ProxQpSolver(accuracy=ACCURACY, max_iterations=ITERATIONS, max_inner_iterations=INNER)
        self.reset()

    def _share_wrenches(self) -> None:
        """Rows of the wrenches but that of the load, in weights and weights times a metre."""
        at, weight = self._asked + 1, self.free.weight
        for wrench in self._wrenches:
            for k in range(3, WRENCH):
                self._T[at, wrench.start + k] = 1.0 / weight
                at += 1
        for k in (X, Y):
            self._T[at, self._wrenches[0].start + k] = 1.0 / weight
            self._T[at, self._wrenches[1].start + k] = -1.0 / weight
            at += 1

    def reset(self) -> None:
        """Forget what was solved before."""
        self._last: BothFeetSolution | None = None
        self.counts = dict.fromkeys(("linear", "program", "relaxed", "held"), 0)

    def solve(self, state: SpaceState, targets: BothFeetTargets) -> BothFeetSolution:
        """The torques at a state."""
        qp = self._write(state, targets)
        solution = self._linear(qp, state)
        for how, solver in (("program", self._solver), ("relaxed", self._relaxed)):
            if solution is not None:
                break
            if how == "relaxed":
                k = self._motion_rows.start
                qp = qp._replace(C=qp.C[:k], l=qp.l[:k], u=qp.u[:k])
            answer = solver.solve(qp)
            if answer.solved:
                solution = self._answer(how, state, answer.x)
        if solution is None:
            self.counts["held"] += 1
            tau = np.zeros(self._n) if self._last is None else self._last.tau
            wrench = np.zeros(WRENCH)
            return BothFeetSolution(tau, np.zeros(self._nv), wrench, False, HELD, wrench)
        self._last = solution
        return solution

    def _write(self, state: SpaceState, targets: BothFeetTargets) -> QuadraticProgram:
        """The program in scaled variables; its arrays are overwritten by the next call."""
        s, nv, A, b, T, t, scale = self.settings, self._nv, self._A, self._b, self._T, self._t, self._scale
        weight = self.free.weight
        A[:BASE, :nv] = state.M[:BASE] / weight
        b[:BASE] = -state.bias[:BASE] / weight
        for wrench, (foot, side) in zip(self._wrenches, enumerate(Stance), strict=True):
            stands, at = state.feet[side], BASE + foot * WRENCH
            A[:BASE, wrench] = -stands.J[:, :BASE].T * (scale[wrench] / weight)
            A[at : at + WRENCH, :nv] = stands.J / ACCELERATION
            b[at : at + WRENCH] = (-stands.drift - s.stance * stands.velocity) / ACCELERATION

        soft = targets.softness
        J, drift = state.com_rows
        T[COM, :nv], t[COM] = J[:Z], targets.com_acceleration - drift[:Z]
        for i, (side, asked) in enumerate(
            ((Stance.LEFT, targets.left_length), (Stance.RIGHT, targets.right_length)), LENGTHS.start
        ):
            leg = state.legs[side]
            T[i, :nv] = leg.J[LENGTH]
            error = leg.values[LENGTH] - state.lengths[side] - asked.offset
            t[i] = asked.acceleration + held(s.length, soft, error, leg.rates[LENGTH] - asked.rate) - leg.drift[LENGTH]
        pelvis = state.pelvis
        T[PELVIS, :nv] = pelvis.J[PITCH:]
        t[PELVIS] = turned(s.pelvis, soft, pelvis, targets.pelvis_yaw)
        out = self._outside
        error = state.q[BASE + 1 + out] - targets.joints[out]
        t[OUTSIDE : self._asked] = held(s.posture, 1.0, error, state.v[BASE + out])
        load = T[self._asked]
        load[self._wrenches[0].start + Z] = (1.0 - targets.share) / weight
        load[self._wrenches[1].start + Z] = -targets.share / weight

        weighted, wanted = T * (scale * self._worth[:, None]), t * self._worth
        C, l, u, effort = self._C, self._l, self._u, self._effort
        torques, motion = self._torque_rows, self._motion_rows
        h = state.bias[BASE:]
        C[torques, :nv] = state.M[BASE:] / effort[:, None]
        for wrench, side in zip(self._wrenches, Stance, strict=True):
            C[torques, wrench] = -state.feet[side].J[:, BASE:].T * scale[wrench] / effort[:, None]
        l[torques], u[torques] = -1.0 - h / effort, 1.0 - h / effort
        bounds = self._motion.at(state)
        np.clip(bounds.lower / ACCELERATION, -UNBOUNDED, UNBOUNDED, out=l[motion])
        np.clip(bounds.upper / ACCELERATION, -UNBOUNDED, UNBOUNDED, out=u[motion])
        return QuadraticProgram(weighted.T @ weighted, -(wanted @ weighted), A, b, C, l, u)

    def _linear(self, qp: QuadraticProgram, state: SpaceState) -> BothFeetSolution | None:
        """The answer without limits, if it keeps them."""
        n, p = len(qp.g), len(qp.b)
        K = np.zeros((n + p, n + p))
        K[:n, :n], K[n:, :n], K[:n, n:] = qp.H, qp.A, qp.A.T
        *_, found, singular = dgesv(K, np.concatenate([-qp.g, qp.b]))
        if singular:
            return None
        x = found[:n]
        value = qp.C @ x
        if (value < qp.l - KEPT_TO).any() or (value > qp.u + KEPT_TO).any():
            return None
        return self._answer("linear", state, x)

    def _answer(self, how: str, state: SpaceState, scaled: FloatArray) -> BothFeetSolution:
        self.counts[how] += 1
        x = scaled * self._scale
        dv, left, right = x[: self._nv], x[self._wrenches[0]], x[self._wrenches[1]]
        tau = state.M[BASE:] @ dv + state.bias[BASE:]
        for wrench, side in ((left, Stance.LEFT), (right, Stance.RIGHT)):
            tau = tau - wrench @ state.feet[side].J[:, BASE:]
        given_way = GIVEN_WAY if how == "relaxed" else ""
        tau = np.clip(tau, -self._effort, self._effort)  # of rounding
        return BothFeetSolution(tau, dv, left, not given_way, given_way, right)
