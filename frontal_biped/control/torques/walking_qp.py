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
ankle. Where the outputs are functions of the sway s, dds = J ddq + drift takes the place of ddbeta (`linearisation`).
Four targets meet four freedoms: while no limit is active both costs vanish, the solution is the input-output
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

from frontal_biped.control.torques.limits import WalkingLimits
from frontal_biped.control.torques.linearisation import FRI, JOINTS, StanceDynamics, Targets
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.chain import GRAVITY
from frontal_biped.numerics.quadratic_program import UNBOUNDED, QuadraticProgram

OUTPUT_ACCELERATION = 10.0  # a_0 [rad/s^2]
TORQUE_LEVER = 0.1  # T_0 = m g times this [m], of the order of a sole

FORCES = 2  # F_h, F_v; N_0 is not a variable, for it follows from u_1 and F_h
VARIABLES = 2 * JOINTS + FORCES
DDQ, U, FORCE = slice(0, JOINTS), slice(JOINTS, 2 * JOINTS), slice(2 * JOINTS, VARIABLES)
BETA, BODY = DDQ.start, slice(DDQ.start + 1, DDQ.stop)  # of ddq: stance ankle, and the joints that the outputs are of
ANKLE = U.start
F_H, F_V = range(FORCE.start, FORCE.stop)
DELTA = VARIABLES
CONTACT = 5
"""Inequalities of the contact: two sides of the friction cone, two ends of the sole, the normal force."""


class Rows(NamedTuple):
    """Which inequalities are which; empty slices where a program has none."""

    contact: slice
    torque: slice
    joint: slice
    decrease: slice

    @classmethod
    def of(cls, joints: bool, decrease: bool) -> "Rows":
        """Of a program with or without limits of the joints' motion and a control Lyapunov function."""
        sizes = (CONTACT, JOINTS, JOINTS if joints else 0, 2 if decrease else 0)
        ends = np.cumsum(sizes).tolist()
        return cls(*(slice(end - size, end) for size, end in zip(sizes, ends, strict=True)))


class PosedProgram(NamedTuple):
    """The program of one tick.

    Attributes:
        program: its first ten variables times `WalkingQp.scale` are (ddq, u, F_h, F_v) in SI units.
        delta_unit: unit of delta, the last variable with a control Lyapunov function [rad/s^2].
    """

    program: QuadraticProgram
    delta_unit: float


class WalkingQp:
    """Poses the program of a tick.

    Args:
        biped: the robot.
        limits: what it keeps.
        relaxation_price: rho of a control Lyapunov function; None: the output accelerations are given.

    Attributes:
        limits: what is kept.
        rows: which inequalities are which.
        scale: (10,) units of ddq, u and F.
        torque_unit: T_0 [N m].
        price: rho, zero without a control Lyapunov function [-].
        fixed: the program without what changes from tick to tick.
        moment: (10,) row of N_0 / T_0 in the program's variables.
        moment_constant: what N_0 / T_0 has beside them [-].
    """

    def __init__(self, biped: FrontalBiped, limits: WalkingLimits, relaxation_price: float | None = None) -> None:
        self.limits = limits
        contact_limits, joint_limits = limits
        T_0, F_0 = TORQUE_LEVER * biped.weight, biped.weight
        self.torque_unit, self._F_0 = T_0, F_0
        self.scale = np.array([1.0] * JOINTS + [T_0] * JOINTS + [F_0] * FORCES)
        self.price = relaxation_price or 0.0
        n = VARIABLES if relaxation_price is None else VARIABLES + 1
        self.rows = Rows.of(joint_limits is not None, relaxation_price is not None)
        # N_0 / T_0 = moment_row . x + moment_constant
        foot = biped.chain.bodies[0]
        moment_row = np.zeros(VARIABLES)
        moment_row[BETA] = -biped.chain.armature[0] / T_0
        moment_row[ANKLE] = 1.0
        moment_row[F_H] = -biped.ankle_height * F_0 / T_0
        moment_constant = foot.mass * GRAVITY * float(foot.com[0]) / T_0
        self.moment, self.moment_constant = moment_row, moment_constant
        # outputs and FRI: residual = task x - goal
        self._task = np.zeros((JOINTS, VARIABLES))
        self._task[:FRI, BODY] = np.eye(FRI) / OUTPUT_ACCELERATION
        self._task[FRI] = moment_row
        self._goal = np.zeros(JOINTS)
        self._goal[FRI] = -moment_constant
        A = np.zeros((JOINTS + FORCES, n))
        A[:, U.start : VARIABLES] = np.eye(JOINTS + FORCES)
        contact, torque, joint, decrease = self.rows
        C = np.zeros((decrease.stop, n))
        C[0, FORCE], C[1, FORCE] = (1.0, contact_limits.friction), (-1.0, contact_limits.friction)
        C[2, :VARIABLES], C[3, :VARIABLES] = moment_row, -moment_row
        C[2, F_V] -= contact_limits.fri_outer * F_0 / T_0
        C[3, F_V] += contact_limits.fri_inner * F_0 / T_0
        C[4, F_V] = 1.0
        C[torque, U] = np.eye(JOINTS)
        l, u = np.zeros(len(C)), np.full(len(C), UNBOUNDED)
        l[contact] = 0.0, 0.0, -moment_constant, moment_constant, contact_limits.min_normal_force / F_0
        l[torque], u[torque] = -contact_limits.max_torque / T_0, contact_limits.max_torque / T_0
        if joint_limits is not None:
            C[joint, DDQ] = np.eye(JOINTS) / OUTPUT_ACCELERATION
        if relaxation_price is not None:
            C[decrease, DELTA] = -1.0, 1.0
            l[decrease.start] = -UNBOUNDED
        self.fixed = QuadraticProgram(np.zeros((n, n)), np.zeros(n), A, np.zeros(JOINTS + FORCES), C, l, u)

    def pose(self, dynamics: StanceDynamics, targets: Targets) -> PosedProgram:
        """The program at the state of the dynamics."""
        program = QuadraticProgram(*(part.copy() for part in self.fixed))
        T_0, F_0 = self.torque_unit, self._F_0
        M, bias = dynamics.M, dynamics.bias
        np.divide(M[BASE:, BASE:], -T_0, out=program.A[:JOINTS, DDQ])
        np.divide(M[:FORCES, BASE:], -F_0, out=program.A[JOINTS:, DDQ])
        np.divide(bias[BASE:], T_0, out=program.b[:JOINTS])
        np.divide(bias[:FORCES], F_0, out=program.b[JOINTS:])
        task, goal = self._task.copy(), self._goal.copy()
        drift = targets.h_d2_dbeta2
        if targets.sway is None:
            np.divide(targets.h_d1, -OUTPUT_ACCELERATION, out=task[:FRI, BETA])
        else:
            task[:FRI, DDQ] -= np.outer(targets.h_d1 / OUTPUT_ACCELERATION, targets.sway.J)
            drift = drift + targets.h_d1 * targets.sway.drift
        task[FRI, F_V] = -targets.p_fri * F_0 / T_0
        goal[:FRI] = (drift if targets.decrease else targets.ddy + drift) / OUTPUT_ACCELERATION
        H, g = task.T.dot(task), goal.dot(task)
        # off the gait h_d' and v may be thousands; the cost in units of its own size, or ProxQP stalls
        unit = max(1.0, H.trace().item(), np.abs(g).max().item())
        program.H[:VARIABLES, :VARIABLES] = H / unit
        program.g[:VARIABLES] = g / -unit
        if self.limits.joints is not None:
            lower, upper = self.limits.joints.bounds(dynamics.state)
            joint = self.rows.joint
            np.clip(lower / OUTPUT_ACCELERATION, -UNBOUNDED, UNBOUNDED, out=program.l[joint])
            np.clip(upper / OUTPUT_ACCELERATION, -UNBOUNDED, UNBOUNDED, out=program.u[joint])
        if not targets.decrease:
            return PosedProgram(program, OUTPUT_ACCELERATION)
        n, b = targets.decrease
        row = self.rows.decrease.start
        slope = -n.dot(targets.h_d1).item()
        # the row, and delta with it, likewise
        size = OUTPUT_ACCELERATION * max(1.0, abs(slope) / OUTPUT_ACCELERATION)
        program.C[row, BETA] = slope / size
        program.C[row, BODY] = n / size
        if targets.sway is not None:
            program.C[row, DDQ] = (np.append(0.0, n) + slope * targets.sway.J) / size
        program.u[row] = (n.dot(drift) - b) / size if n.any() else UNBOUNDED
        program.g[DELTA] = self.price * size / (OUTPUT_ACCELERATION * unit)
        return PosedProgram(program, size)
