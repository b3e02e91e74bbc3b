"""The controller's quadratic program: input-output linearisation under torque, contact, foot and joint limits.

Decision variables x = (ddq (4), u (4), F_h, F_v).

    minimise    1/2 |(ddy - v) / a_0|^2 + 1/2 |(N_0 - p_FRI^d F_v) / T_0|^2
    subject to  D ddq + C dq + G = u                       dynamics of the pinned robot
                F = m (a_cm + (0, g))                      ground reaction
                |u| <= u_max                               torque limits
                F_v >= F_min                               unilateral contact
                |F_h| <= mu F_v                            friction cone
                outer F_v <= N_0 <= inner F_v              FRI inside the sole
                ddq_min(q, dq) <= ddq <= ddq_max(q, dq)    joint limits (see `limits`)

ddy = ddq_b - h_d' ddbeta - h_d'' dbeta^2 is the acceleration of the output y = q_b - h_d(beta), v the one asked for,
and N_0 = u_1 - armature ddq_1 - h_a F_h + m_f g c_f the moment of the ground reaction about the ground below the
ankle. Four targets meet four freedoms: while no limit is active both costs vanish, the solution is the input-output
linearising torque with the FRI on its target, and the weights a_0 and T_0 do not matter. Inside the program u and F
are in units of T_0 and m g, and every row likewise, so that one absolute tolerance fits all.

With a control Lyapunov function (see `lyapunov`) v is no longer given; its place takes an inequality, relaxed by one
more variable delta:

    minimise    1/2 |ddy / a_0|^2 + rho delta / a_0 + 1/2 |(N_0 - p_FRI^d F_v) / T_0|^2
    subject to  n . ddy + b <= delta,   delta >= 0,    and all of the above

Output and FRI are four independent functions of ddq, so that here too the solution is known while no limit is active:
the least v alone, with the FRI on its target.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limits import ContactLimits, JointLimits
from frontal_biped.control.torques.linearisation import Motion, StanceDynamics, Targets
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.chain import GRAVITY
from frontal_biped.numerics.quadratic_program import UNBOUNDED, QuadraticProgram

VARIABLES = 10
OUTPUT_ACCELERATION = 10.0  # a_0 [rad/s^2]
TORQUE_LEVER = 0.1  # T_0 = m g times this [m], of the order of a sole
DDQ, U, FORCE, DELTA = slice(0, 4), slice(4, 8), slice(8, 10), 10


class Rows(NamedTuple):
    """Which inequalities are which; empty slices where a program has none."""

    contact: slice
    torque: slice
    joint: slice
    decrease: slice


class WalkingQp:
    """Builds the program at a state; matrices are allocated once and overwritten at every call.

    Args:
        biped: the robot.
        limits: of contact and motors.
        joints: of the joints' motion; None: none.
        relaxation_price: rho of a control Lyapunov function; None: the output accelerations are given.

    Attributes:
        dynamics: at the state moved to.
        rows: which inequalities are which.
        scale: (10,) units of ddq, u and F.
        delta_unit: unit of delta in the program just built [rad/s^2].
    """

    def __init__(
        self,
        biped: FrontalBiped,
        limits: ContactLimits,
        joints: JointLimits | None = None,
        relaxation_price: float | None = None,
    ) -> None:
        self.biped = biped
        self.limits = limits
        self.joints = joints
        T_0, F_0 = TORQUE_LEVER * biped.weight, biped.weight
        self._T_0, self._F_0 = T_0, F_0
        self.scale = np.array([1.0] * 4 + [T_0] * 4 + [F_0] * 2)
        n = VARIABLES if relaxation_price is None else VARIABLES + 1
        last = 9 if joints is None else 13
        self.rows = Rows(slice(0, 5), slice(5, 9), slice(9, last), slice(last, last + 2 * (n - VARIABLES)))
        self.dynamics = StanceDynamics(biped)
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
        A = np.zeros((6, n))
        A[:, 4:VARIABLES] = np.eye(6)
        contact, torque, joint, decrease = self.rows
        C = np.zeros((decrease.stop, n))
        C[0, FORCE], C[1, FORCE] = (1.0, limits.friction), (-1.0, limits.friction)
        C[2, :VARIABLES], C[3, :VARIABLES] = moment_row, -moment_row
        C[2, 9] -= limits.fri_outer * F_0 / T_0
        C[3, 9] += limits.fri_inner * F_0 / T_0
        C[4, 9] = 1.0
        C[torque, U] = np.eye(4)
        l, u = np.zeros(len(C)), np.full(len(C), UNBOUNDED)
        l[contact] = 0.0, 0.0, -moment_constant, moment_constant, limits.min_normal_force / F_0
        l[torque], u[torque] = -limits.max_torque / T_0, limits.max_torque / T_0
        if joints is not None:
            C[joint, DDQ] = np.eye(4) / OUTPUT_ACCELERATION
        self._relaxation_price = relaxation_price or 0.0
        self.delta_unit = OUTPUT_ACCELERATION
        if relaxation_price is not None:
            C[decrease, DELTA] = -1.0, 1.0
            l[decrease.start] = -UNBOUNDED
        self.program = QuadraticProgram(np.zeros((n, n)), np.zeros(n), A, np.zeros(6), C, l, u)

    def move_to(self, q: FloatArray, dq: FloatArray) -> None:
        """Evaluate the dynamics at q (4,) [rad], dq (4,) [rad/s]: before any of the calls below."""
        self._q, self._dq = q, dq
        self.dynamics.move_to(q, dq)

    def keeps_limits(self, motion: Motion) -> bool:
        """Does a motion at this state meet every constraint?

        Where it also meets the targets (`StanceDynamics.linearising`), both costs are zero (with a control Lyapunov
        function: the least of any v, and zero), and no other can be better: it is the program's optimum.
        """
        if not self.limits.keeps(motion.forces.tolist()):
            return False
        return self.joints is None or self.joints.keeps(self._q, self._dq, motion.ddq)

    def build(self, targets: Targets) -> QuadraticProgram:
        """The program; its arrays are reused by the next call.

        The first ten variables of its solution times `scale` are (ddq, u, F_h, F_v) in SI units.
        """
        M, bias = self.dynamics.M, self.dynamics.bias
        program = self.program
        np.divide(M[BASE:, BASE:], -self._T_0, out=program.A[:4, DDQ])
        np.divide(M[:2, BASE:], -self._F_0, out=program.A[4:, DDQ])
        np.divide(bias[BASE:], self._T_0, out=program.b[:4])
        np.divide(bias[:2], self._F_0, out=program.b[4:])
        task, goal = self._task, self._goal
        np.divide(targets.h_d1, -OUTPUT_ACCELERATION, out=task[:3, 0])
        task[3, 9] = -targets.p_fri * self._F_0 / self._T_0
        drift = targets.h_d2_dbeta2
        goal[:3] = (drift if targets.decrease else targets.ddy + drift) / OUTPUT_ACCELERATION
        H, g = task.T.dot(task), goal.dot(task)
        # off the gait h_d' and v may be thousands; the cost in units of its own size, or ProxQP stalls
        unit = max(1.0, H.trace().item(), np.abs(g).max().item())
        program.H[:VARIABLES, :VARIABLES] = H / unit
        program.g[:VARIABLES] = g / -unit
        if self.joints is not None:
            lower, upper = self.joints.bounds(self._q, self._dq)
            joint = self.rows.joint
            np.clip(lower / OUTPUT_ACCELERATION, -UNBOUNDED, UNBOUNDED, out=program.l[joint])
            np.clip(upper / OUTPUT_ACCELERATION, -UNBOUNDED, UNBOUNDED, out=program.u[joint])
        if targets.decrease:
            n, b = targets.decrease
            row = self.rows.decrease.start
            slope = -n.dot(targets.h_d1).item()
            # the row, and delta with it, likewise
            size = OUTPUT_ACCELERATION * max(1.0, abs(slope) / OUTPUT_ACCELERATION)
            program.C[row, 0] = slope / size
            program.C[row, 1:4] = n / size
            program.u[row] = (n.dot(drift) - b) / size if n.any() else UNBOUNDED
            program.g[DELTA] = self._relaxation_price * size / (OUTPUT_ACCELERATION * unit)
            self.delta_unit = size
        return program
