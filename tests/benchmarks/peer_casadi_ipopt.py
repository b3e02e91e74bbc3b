"""The peer of the gait design: the same problem written a second time, in CasADi, solved by IPOPT.

    python tests/benchmarks/peer_casadi_ipopt.py [--max-pelvis-roll DEGREES] [--verbose]

Needs ``pip install 'frontal-biped[bench]'``. Nothing of the package's mathematics is used: the planar chain is
written in closed form from the numbers of `FrontalChain`, the zero dynamics by quadrature from the reversal on
Chebyshev nodes, and hybrid invariance, final pose, continuity of the FRI and periodicity are the 17 equality
constraints of 47 variables. IPOPT gets exact gradients, Jacobians and Hessians by algorithmic differentiation. Only
the start (the package's default) and the check of the answer (the package's dense grid) are shared. The robot's joint
limits, which the package imposes besides C01 to C09, are left out unless asked for; they do not bind on the Table I
robot.
"""

import argparse
import time
from dataclasses import dataclass
from math import comb
from typing import Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np

import frontal_biped as fb
from frontal_biped.arrays import FloatArray
from frontal_biped.design.problem import DesignProblem
from frontal_biped.gait.check import ConstraintCheck, check_constraints
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import GRAVITY, JOINTS, UPRIGHT, FrontalChain
from frontal_biped.virtual_constraints import complete
from frontal_biped.virtual_constraints.invariance import FreeParameters, invariance_residuals
from frontal_biped.virtual_constraints.phase import Phase
from frontal_biped.zero_dynamics.poincare import StepOrbit, step_orbit

NODES = 21
CHECK_NODES = 40
ON_THE_GRID = 1e-6
"""Scaled violation on the dense grid at which `Peer.solve_on_grid` counts a bound as kept."""

ROUNDS = 6
"""Solutions of `Peer.solve_on_grid`, each with bounds moved inwards by what the dense grid found."""

Column = Any  # a CasADi column: one entry a node
Vector = tuple[Column, Column]  # (h, v)


def cross(a: Vector, b: Vector) -> Column:
    return a[0] * b[1] - a[1] * b[0]


def minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1]


# ---------------------------------------------------------------------- quadrature from the reversal
def chebyshev_quadrature(size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes tau on [0, 1], weights of int_0^1 f dtau, and the matrix of g -> int_0^1 r g(tau r) dr."""
    tau = 0.5 - 0.5 * np.cos(np.pi * np.arange(size) / (size - 1))

    def basis(t: FloatArray) -> FloatArray:
        return np.polynomial.chebyshev.chebvander(2.0 * t - 1.0, size - 1)

    r, w = np.polynomial.legendre.leggauss(size)
    r, w = 0.5 * (r + 1.0), 0.5 * w
    to_coefficients = np.linalg.inv(basis(tau))
    inner = sum(wk * rk * basis(tau * rk) for rk, wk in zip(r, w, strict=True))
    return tau, (w @ basis(r)) @ to_coefficients, inner @ to_coefficients


def bezier(coefficients: Column, s: FloatArray) -> tuple[Column, Column, Column]:
    """Value and the first two derivatives with respect to s of a Bezier polynomial, at s (n,)."""

    def values(points: Column) -> Column:
        n = points.numel() - 1
        basis = np.array([comb(n, k) * s**k * (1.0 - s) ** (n - k) for k in range(n + 1)]).T
        return ca.mtimes(ca.DM(basis), points)

    degree = coefficients.numel() - 1
    first = degree * ca.diff(coefficients)
    second = (degree - 1) * ca.diff(first) if degree > 1 else ca.DM.zeros(1)
    return values(coefficients), values(first), values(second)


# ---------------------------------------------------------------------- planar chain
class SymbolicBody(NamedTuple):
    """`Body` of a chain, of symbols."""

    mass: Column
    com: Column
    inertia: Column


class SymbolicChain(NamedTuple):
    """What is used of a `FrontalChain`, of symbols: one graph then serves every robot."""

    bodies: list[SymbolicBody]
    joints: list[Column]
    armature: Column
    max_torque: Column
    ankle_height: Column
    sole_inner: Column
    sole_outer: Column

    @classmethod
    def of(cls, numbers: Column) -> "SymbolicChain":
        """A chain of the symbols that `chain_numbers` puts in a row."""
        bodies, joints, armature, torque, rest = ca.vertsplit(numbers, [0, 20, 28, 32, 36, 39])
        parts = [ca.vertsplit(body, [0, 1, 3, 4]) for body in ca.vertsplit(bodies, 4)]
        return cls(
            [SymbolicBody(*part) for part in parts], ca.vertsplit(joints, 2), armature, torque, *ca.vertsplit(rest)
        )


Chain = FrontalChain | SymbolicChain


def chain_numbers(chain: FrontalChain, torque: FloatArray) -> FloatArray:
    """(39,) what a `SymbolicChain` stands for, with these torque limits (4,)."""
    bodies = [[body.mass, *body.com, body.inertia] for body in chain.bodies]
    rest = [chain.ankle_height, chain.sole_inner, chain.sole_outer]
    return np.concatenate([np.ravel(bodies), np.ravel(chain.joints), chain.armature, torque, rest])


@dataclass(frozen=True)
class ChainMotion:
    """A curve q(beta) of the chain: points and their first two derivatives with respect to beta, one row a node."""

    joints: list[tuple[Vector, Vector, Vector]]
    centres: list[tuple[Vector, Vector, Vector]]
    rotation: list[tuple[Column, Column, Column]]
    sole: list[tuple[Vector, Vector, Vector]]


def chain_motion(
    chain: FrontalChain | SymbolicChain, q: list[Column], dq: list[Column], ddq: list[Column]
) -> ChainMotion:
    """Forward kinematics of stance foot, stance leg, pelvis, swing leg, swing foot (bodies 0 to 4)."""
    still = (0.0 * q[0], 0.0 * q[0])
    joints, centres, rotation = [], [(_constant(chain.bodies[0].com, q[0]), still, still)], [(still[0],) * 3]
    point = (_constant(chain.joints[0], q[0]), still, still)
    angle, rate, change = rotation[0]
    for i in range(4):
        joints.append(point)
        angle, rate, change = angle + q[i] - UPRIGHT, rate + dq[i], change + ddq[i]
        rotation.append((angle, rate, change))
        centres.append(_carried(point, chain.bodies[i + 1].com - chain.joints[i], rotation[-1]))
        if i < 3:
            point = _carried(point, chain.joints[i + 1] - chain.joints[i], rotation[-1])
    ends = ((-chain.sole_inner, -chain.ankle_height), (chain.sole_outer, -chain.ankle_height))
    return ChainMotion(joints, centres, rotation, [_carried(point, end, rotation[-1]) for end in ends])


def _number(value: Any) -> Any:
    """A symbol as it is, a number without NumPy's ways of multiplying."""
    return value if isinstance(value, ca.SX) else float(value)


def _constant(point: Any, like: Column) -> Vector:
    return _number(point[0]) + 0.0 * like, _number(point[1]) + 0.0 * like


def _carried(
    origin: tuple[Vector, Vector, Vector], offset: Any, rotation: tuple[Column, Column, Column]
) -> tuple[Vector, Vector, Vector]:
    """A point of a link at ``offset`` (upright) from a joint."""
    angle, rate, change = rotation
    x, y = _number(offset[0]), _number(offset[1])
    h, v = ca.cos(angle) * x - ca.sin(angle) * y, ca.sin(angle) * x + ca.cos(angle) * y
    (p, dp, ddp) = origin
    return (
        (p[0] + h, p[1] + v),
        (dp[0] - rate * v, dp[1] + rate * h),
        (ddp[0] - change * v - rate**2 * h, ddp[1] + change * h - rate**2 * v),
    )


@dataclass(frozen=True)
class Wrench:
    """Ground reaction (F_h, F_v, moment about the origin) and joint torques: rows of w = A ddbeta + B dbeta^2 + G."""

    A: list[Column]
    B: list[Column]
    G: list[Column]


def newton_euler(
    chain: FrontalChain | SymbolicChain, motion: ChainMotion, dq: list[Column], ddq: list[Column]
) -> Wrench:
    """Inverse dynamics, from the swing foot inwards; the stance foot rests."""
    zero = 0.0 * dq[0]
    A, B, G = [zero] * 7, [zero] * 7, [zero] * 7
    for b in range(4, -1, -1):
        body, (r, dr, ddr), (_, rate, change) = chain.bodies[b], motion.centres[b], motion.rotation[b]
        for rows, rotation, (h, v) in ((A, rate, dr), (B, change, ddr), (G, zero, (zero, GRAVITY))):
            # force of this body and all beyond it, and its moment about the origin
            rows[0], rows[1] = rows[0] + body.mass * h, rows[1] + body.mass * v
            rows[2] = rows[2] + body.mass * cross(r, (h, v)) + body.inertia * rotation
            if b > 0:
                rows[2 + b] = rows[2] - cross(motion.joints[b - 1][0], (rows[0], rows[1]))
    for j in range(4):
        A[3 + j] = A[3 + j] + _number(chain.armature[j]) * dq[j]
        B[3 + j] = B[3 + j] + _number(chain.armature[j]) * ddq[j]
    return Wrench(A, B, G)


# ---------------------------------------------------------------------- impact
@dataclass(frozen=True)
class SymbolicImpact:
    """Per unit of dbeta_f-: joint rates after the impact (old numbering), impulse, its moment, lift-off speeds."""

    rates: Column
    impulse: Vector
    moment: Column
    lift_off: Column


def impact(chain: Chain, motion: ChainMotion, dq: list[Column], at: int) -> SymbolicImpact:
    """The swing foot lands and sticks.

    No impulse acts but on the landing foot, so the angular momentum about joint j of everything beyond it, seen from
    the landing foot (bodies 0 .. j-1), is the same before and after: four equations for the four joint rates.
    """

    def pick(vector: Vector) -> Vector:
        return vector[0][at], vector[1][at]

    centres = [pick(centre[0]) for centre in motion.centres]
    before = [pick(centre[1]) for centre in motion.centres]
    turning = [rotation[1][at] for rotation in motion.rotation]
    joints = [pick(joint[0]) for joint in motion.joints]
    D, h = ca.SX(4, 4), ca.SX(4, 1)
    for j in range(4):
        h[j] = _number(chain.armature[j]) * dq[j][at]
        for b in range(j + 1):
            body, lever = chain.bodies[b], minus(centres[b], joints[j])
            h[j] -= body.mass * cross(lever, before[b]) + body.inertia * turning[b]
        for k in range(4):
            for b in range(min(j, k) + 1):
                body = chain.bodies[b]
                one, other = minus(centres[b], joints[j]), minus(centres[b], joints[k])
                D[j, k] += body.mass * (one[0] * other[0] + one[1] * other[1]) + body.inertia
        D[j, j] += _number(chain.armature[j])
    rates = ca.solve(D, h)
    ankle = joints[3]
    foot = (ankle[0], ankle[1] - chain.ankle_height)
    L_h = L_v = moment = ca.SX(0)
    for b, body in enumerate(chain.bodies):
        # a point of body b turns about every joint between it and the landing foot, backwards
        after = [ca.SX(0), ca.SX(0), ca.SX(0)]
        for j in range(b, 4):
            lever = minus(centres[b], joints[j])
            after = [after[0] + rates[j] * lever[1], after[1] - rates[j] * lever[0], after[2] - rates[j]]
        jump = (body.mass * (after[0] - before[b][0]), body.mass * (after[1] - before[b][1]))
        L_h, L_v = L_h + jump[0], L_v + jump[1]
        moment += cross(minus(centres[b], foot), jump) + body.inertia * (after[2] - turning[b])
    ends = [chain.sole_inner, -chain.sole_outer]
    lift_off = [sum(-rates[j] * (end - joints[j][0]) for j in range(4)) for end in ends]
    return SymbolicImpact(rates, (L_h, L_v), moment, ca.vertcat(*lift_off))


# ---------------------------------------------------------------------- zero dynamics
@dataclass(frozen=True)
class SymbolicPhase:
    """One phase on the nodes, from the reversal (first) to the impact (last)."""

    q: list[Column]
    dq: list[Column]
    motion: ChainMotion
    p_fri: Column
    Delta: Column
    I_P: Column
    kappa_2: Column
    exponent: Column
    z: Column
    dbeta: Column
    forces: list[Column]
    duration: Column
    squared_torque: Column


def zero_dynamics(
    chain: FrontalChain | SymbolicChain,
    size: int,
    direction: int,
    start: Column,
    end: Column,
    joints: Column,
    fri: Column,
) -> SymbolicPhase:
    """zeta = tau^2 z from the reversal; ``joints`` (3, M + 1) and ``fri`` (M_FRI + 1,) are Bezier coefficients."""
    tau, weights, Q = chebyshev_quadrature(size)
    s = 1.0 - tau**2 if direction > 0 else tau**2
    span = end - start
    rows = [bezier(joints[i, :].T, s) for i in range(3)]
    one = ca.SX.ones(size, 1)
    q = [start + span * ca.DM(s)] + [row[0] for row in rows]
    dq = [one] + [row[1] / span for row in rows]
    ddq = [0.0 * one] + [row[2] / span**2 for row in rows]
    p_fri, dp_ds, _ = bezier(fri, s)
    dp_fri = dp_ds / span
    motion = chain_motion(chain, q, dq, ddq)
    w = newton_euler(chain, motion, dq, ddq)
    Delta = direction * span
    I_P = w.A[2] - p_fri * w.A[1]
    kappa_2 = p_fri * w.G[1] - w.G[2]
    exponent = -2.0 * Delta * ca.DM(tau**2) * ca.mtimes(ca.DM(Q), -2.0 * dp_fri * w.A[1] / I_P)
    z = -2.0 * Delta * ca.exp(exponent) * ca.mtimes(ca.DM(Q), ca.exp(-exponent) * kappa_2 * I_P)
    root = ca.sqrt(2.0 * z)
    dbeta = direction * ca.DM(tau) * root / I_P
    ddbeta = (kappa_2 - (w.B[2] - p_fri * w.B[1]) * dbeta**2) / I_P
    forces = [a * ddbeta + b * dbeta**2 + g for a, b, g in zip(w.A, w.B, w.G, strict=True)]
    density = ca.DM(weights) * 2.0 * Delta * I_P / root
    squared = sum(ca.dot(density, u**2) for u in forces[3:])
    return SymbolicPhase(
        q, dq, motion, p_fri, Delta, I_P, kappa_2, exponent, z, dbeta, forces, ca.sum1(density), squared
    )


# ---------------------------------------------------------------------- the nonlinear programme
@dataclass(frozen=True)
class PeerResult:
    """Where IPOPT ended.

    Attributes:
        cost: J [N^2 m s] by the peer's own quadrature.
        x: (47,) variables.
        iterations: of IPOPT.
        success: did IPOPT report success?
        status: IPOPT's own word.
        evaluations: of the objective, its gradient and the Hessian.
        seconds: wall time of the solve alone.
    """

    cost: float
    x: FloatArray
    iterations: int
    success: bool
    status: str
    evaluations: tuple[int, int, int]
    seconds: float


class Peer:
    """The design problem as one CasADi graph; building it includes IPOPT's derivative graphs.

    Variables: beta_r-, beta_f-, L_s, both phases' Bezier columns 0..M (column by column), both FRI polynomials.

    Args:
        biped: the robot; only its numbers are read.
        specification: bounds of C01 to C09; one degree for all outputs.
        verbose: let IPOPT print its iterations.
        barrier: IPOPT's mu_strategy; "monotone" is its default.
        size: nodes a phase.
        joint_limits: impose the robot's limits of joint positions and speeds as well.
        shared: take the graph of an earlier peer of the same degrees and nodes, in which the robot's numbers are
            parameters; the first builds it.
    """

    _shared: ClassVar[dict[tuple[int, ...], Any]] = {}

    def __init__(
        self,
        biped: FrontalBiped,
        specification: fb.GaitSpecification,
        verbose: bool = False,
        barrier: str = "adaptive",
        size: int = NODES,
        joint_limits: bool = False,
        shared: bool = False,
    ) -> None:
        self.biped, self.specification, self.joint_limits, self.shared = biped, specification, joint_limits, shared
        began = time.perf_counter()
        M, F = max(specification.degrees), specification.fri_degree
        self.sizes = (3, 3 * (M + 1), 3 * (M + 1), F + 1, F + 1)
        self._rows: list[Column] = []
        self._low: list[FloatArray] = []
        self._high: list[FloatArray] = []
        self._names: list[tuple[str, float, int]] = []
        self.numbers = chain_numbers(biped.chain, specification.torque_limits(biped))
        kind = (M, F, size, joint_limits, barrier == "adaptive")
        known = self._shared.get(kind) if shared else None
        x = ca.SX.sym("x", sum(self.sizes)) if known is None else ca.DM(self.default_start())
        symbols = ca.SX.sym("p", len(self.numbers))
        chain = SymbolicChain.of(symbols) if shared and known is None else biped.chain
        objective = self._formulate(x, chain, size)
        self.low, self.high = np.concatenate(self._low), np.concatenate(self._high)
        self._inwards = np.zeros_like(self.low)
        self.equalities = int(np.sum(self.low == self.high))
        self.formulation_seconds = time.perf_counter() - began
        if known is not None:
            self.solver = known
        else:
            # of five settings tried (monotone barrier, two smaller first barriers, no scaling) the fastest on both
            # public specifications: 31 and 23 iterations, the default 64 and 51
            options: dict[str, Any] = {"print_time": False, "show_eval_warnings": False}
            options |= {"ipopt.sb": "yes", "ipopt.mu_strategy": barrier, "ipopt.max_iter": 500}
            if not verbose:
                options["ipopt.print_level"] = 0
            programme = {"x": x, "f": objective, "g": ca.vertcat(*self._rows)} | ({"p": symbols} if shared else {})
            self.solver = ca.nlpsol("peer", "ipopt", programme, options)
            if shared:
                self._shared[kind] = self.solver
        self.building_seconds = time.perf_counter() - began

    def _add(self, rows: Column, low: float, high: float, name: str = "", unit: float = 1.0) -> None:
        """Rows between bounds; ``name`` of the package's constraint that they are, ``unit`` of it that a 1 is."""
        count = rows.numel()
        self._names.append((name, unit, count))
        self._rows.append(rows)
        self._low.append(np.full(count, low))
        self._high.append(np.full(count, high))

    def _formulate(self, x: Column, chain: Chain, size: int) -> Column:
        spec, add = self.specification, self._add
        inf = float(np.inf)
        head, rising_flat, falling_flat, rising_fri, falling_fri = ca.vertsplit(x, [0, *np.cumsum(self.sizes).tolist()])
        beta_reversal, beta_impact, width = ca.vertsplit(head)
        rising_joints, falling_joints = ca.reshape(rising_flat, 3, -1), ca.reshape(falling_flat, 3, -1)
        beta_start = falling_joints[2, -1]  # relabelled: the swing ankle becomes the stance ankle
        up = zero_dynamics(chain, size, +1, beta_start, beta_reversal, rising_joints, rising_fri)
        down = zero_dynamics(chain, size, -1, beta_reversal, beta_impact, falling_joints, falling_fri)
        end = size - 1
        landing = impact(chain, down.motion, down.dq, end)
        ratio = landing.rates[3]
        before = down.dbeta[end]

        # the 17 equalities
        q_minus, first, last = [q[end] for q in down.q], rising_joints[:, 0], rising_joints[:, -1]
        add(first - ca.vertcat(q_minus[2], q_minus[1], q_minus[0]), 0.0, 0.0)
        slope = ca.vertcat(*[dq[end] for dq in up.dq[1:]])
        add(slope - landing.rates[[2, 1, 0]] / ratio, 0.0, 0.0)
        add(falling_joints[:, 0] - last, 0.0, 0.0)
        add(ca.vertcat(*[a[0] - b[0] for a, b in zip(up.dq[1:], down.dq[1:], strict=True)]), 0.0, 0.0)
        ankle = down.motion.joints[3][0]
        flat = down.motion.rotation[4][0][end]
        add(ca.vertcat(ankle[0][end] - width, ankle[1][end] - chain.ankle_height, flat), 0.0, 0.0)
        add(falling_fri[0] - rising_fri[-1], 0.0, 0.0)
        add(up.dbeta[end] ** 2 - (ratio * before) ** 2, 0.0, 0.0)

        # C01, C02, C03
        named = (("rising", up), ("falling", down))
        jump = ratio * up.I_P[end] / down.I_P[end]
        multiplier = ca.exp(down.exponent[end] - up.exponent[end]) * jump**2
        add(multiplier, 0.0, spec.max_multiplier or 1.0, "multiplier delta_f^2 delta_r^2 delta_z^2")
        add(up.kappa_2[0], -inf, 0.0, "kappa_2 at the reversal (HIP2)")
        for label, phase in named:
            add(phase.Delta, spec.min_phase_range, inf, f"range of beta, {label}")
            add(phase.z, 1e-2, inf, f"zeta/tau^2 of the orbit, {label}")
            add(phase.I_P, 0.0, inf, f"I_P (decoupling), {label}")
        # C04, C05
        tau, _, _ = chebyshev_quadrature(size)
        left = ca.DM(1.0 - tau[:-1] ** 2)
        descent = ca.vertcat(*[sole[1][1][end] * before for sole in down.motion.sole])
        add(descent, -inf, -spec.touchdown_speed, "touchdown speed of both sole ends")
        for label, phase in named:
            name = f"sole height / (1 - t2), {label}"
            for height, climb, _ in phase.motion.sole:
                add(height[1][:-1] / left, spec.swing_clearance, inf, name)
                add(climb[1][end] * phase.Delta, spec.swing_clearance, inf, name)  # the limit of the same at tau = 1
        # C06
        outer, inner = self.biped.sole
        torque, weight = spec.max_torque or tuple(self.biped.max_torque), self.biped.weight
        if isinstance(chain, SymbolicChain):
            torque = tuple(ca.vertsplit(chain.max_torque))
            weight = GRAVITY * sum(body.mass for body in chain.bodies)
        for label, phase in named:
            F_h, F_v, _, *u = phase.forces
            add(F_v / weight, spec.min_normal_force, inf, f"F_v / m g, {label}")
            add(F_h / F_v, -spec.friction, spec.friction, f"F_h / F_v, {label}")
            add(phase.p_fri, outer + spec.fri_margin, inner - spec.fri_margin, f"FRI in the sole, {label}")
            limits = spec.torque_limits(self.biped).tolist()
            for i, (limit, values) in enumerate(zip(torque, u, strict=True)):
                add(values / limit, -1.0, 1.0, f"{JOINTS[i]} torque, {label}", limits[i])
            rotations = ((2, spec.max_pelvis_roll, "pelvis roll"), (4, spec.max_foot_rotation, "swing foot"))
            for body, bound, name in rotations:
                if bound is not None or self.shared:
                    most = inf if bound is None else bound
                    add(phase.motion.rotation[body][0], -most, most, f"{name}, {label}")
            if self.joint_limits:
                self._add_joint_limits(phase, label)
        # C07, C08, C09
        add(landing.impulse[1] * before, 0.0, inf, "normal impulse / m", 1.0 / self.biped.mass)
        add(landing.impulse[0] / landing.impulse[1], -spec.friction, spec.friction, "L_h / L_v")
        add(landing.moment / landing.impulse[1], -inner, -outer, "impulse in the sole")
        add(landing.lift_off * before, 0.0, inf, "lift-off speed of the old stance sole")
        add(up.duration + down.duration, *spec.step_duration, "step duration")
        add(width, *spec.step_width)
        return (up.squared_torque + down.squared_torque) / width

    def _add_joint_limits(self, phase: SymbolicPhase, label: str) -> None:
        limits = zip(self.biped.joint_lower, self.biped.joint_upper, self.biped.joint_max_velocity, strict=True)
        for i, (lower, upper, fastest) in enumerate(limits):
            self._add(phase.q[i], float(lower), float(upper), f"{JOINTS[i]} angle, {label}")
            if np.isfinite(fastest):
                speed = phase.dq[i] * phase.dbeta
                self._add(speed, -float(fastest), float(fastest), f"{JOINTS[i]} speed, {label}")

    # ------------------------------------------------------------------ variables
    def variables(self, free: FreeParameters) -> FloatArray:
        """(47,) variables of the package's free parameters, completed to a hybrid-invariant step."""
        rising, falling = complete(self.biped, free)
        head = np.array([free.beta_reversal, free.beta_impact, free.step_width])
        columns = [phase.joint_bezier.T.ravel() for phase in (rising, falling)]
        return np.concatenate([head, *columns, rising.fri_bezier, falling.fri_bezier])

    def phases(self, x: FloatArray) -> tuple[Phase, Phase]:
        """The package's phases of the variables."""
        head, rising, falling, rising_fri, falling_fri = np.split(x, np.cumsum(self.sizes)[:-1])
        up, down = rising.reshape(-1, 3).T, falling.reshape(-1, 3).T
        reversal, impact_end, _ = (float(value) for value in head)
        return Phase(float(down[2, -1]), reversal, up, rising_fri), Phase(reversal, impact_end, down, falling_fri)

    def default_start(self) -> FloatArray:
        """(47,) the package's default start."""
        problem = DesignProblem(self.biped, self.specification, 16)
        return self.variables(problem.unpack(problem.start()))

    # ------------------------------------------------------------------ solution
    def solve(self, x: FloatArray | None = None) -> PeerResult:
        """Run IPOPT from x (47,), by default from the package's default start."""
        start = self.default_start() if x is None else x
        began = time.perf_counter()
        numbers = {"p": self.numbers} if self.shared else {}
        answer = self.solver(x0=start, lbg=self.low + self._inwards, ubg=self.high - self._inwards, **numbers)
        seconds = time.perf_counter() - began
        stats = self.solver.stats()
        calls = tuple(int(stats.get(f"n_call_nlp_{name}", 0)) for name in ("f", "grad_f", "hess_l"))
        return PeerResult(
            float(answer["f"]),
            np.array(answer["x"]).ravel(),
            int(stats["iter_count"]),
            bool(stats["success"]),
            str(stats["return_status"]),
            calls,
            seconds,
        )

    def solve_on_grid(self) -> PeerResult | None:
        """`solve`, then again with bounds moved inwards until the package's dense grid finds them kept.

        Returns:
            The answer whose largest scaled violation on the dense grid is at most `ON_THE_GRID`; None if there is none.
        """
        self._inwards[:] = 0.0
        result = self.solve()
        for _ in range(ROUNDS):
            if not result.success:
                return None
            missed = [check for check in self._checks(result.x)[1] if -check.margin > ON_THE_GRID * check.scale]
            if not missed:
                return result
            self._move_inwards({check.name: -check.margin for check in missed})
            result = self.solve(result.x)
        return None

    def _move_inwards(self, missed: dict[str, float]) -> None:
        """Tighten rows by what their constraints were missed by, in the constraints' units.

        Raises:
            LookupError: the peer has no row for a constraint that was missed; it would never be met.
        """
        unknown = missed.keys() - {name for name, _, _ in self._names}
        if unknown:
            raise LookupError(f"the peer has no row for {', '.join(sorted(unknown))}")
        row = 0
        for name, unit, count in self._names:
            self._inwards[row : row + count] += 1.2 * missed.get(name, 0.0) / unit
            row += count

    def _checks(self, x: FloatArray) -> tuple[StepOrbit, list[ConstraintCheck]]:
        """The step on the package's quadrature, and its dense checks but for the soles on the ground.

        Whether both soles lie flat to 1e-9 m is the solver's tolerance, and among the residuals.
        """
        rising, falling = self.phases(x)
        step = step_orbit(self.biped, rising, falling, float(x[2]), CHECK_NODES)
        report = check_constraints(self.biped, self.specification, rising, falling, step)
        return step, [check for check in report.checks if "on the ground" not in check.name]

    def package_view(self, x: FloatArray) -> dict[str, float]:
        """The answer seen by the package: J, largest scaled violation on the dense grid, worst invariance residual."""
        rising, falling = self.phases(x)
        step, checks = self._checks(x)
        worst = min(check.margin / check.scale for check in checks)
        return {
            "cost": step.cost,
            "violation": max(0.0, -worst),
            "invariance": max(invariance_residuals(self.biped, rising, falling, float(x[2])).values()),
            "periodicity": abs(step.periodicity),
        }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--max-pelvis-roll", type=float, metavar="DEGREES")
    parser.add_argument("--verbose", action="store_true", help="let IPOPT print its iterations")
    arguments = parser.parse_args()
    roll = arguments.max_pelvis_roll
    specification = fb.GaitSpecification(max_pelvis_roll=None if roll is None else float(np.radians(roll)))
    peer = Peer(fb.load_robot(), specification, arguments.verbose)
    rows = f"{sum(peer.sizes)} variables, {len(peer.low)} rows, {peer.equalities} of them equalities"
    print(f"{rows}; formulated in {peer.formulation_seconds:.2f} s, with derivatives in {peer.building_seconds:.2f} s")
    result = peer.solve()
    print(f"{result.status} in {result.iterations} iterations, {result.seconds:.2f} s: J = {result.cost:.4f} N^2 m s")
    view = peer.package_view(result.x)
    print("the package sees " + ", ".join(f"{name} {value:.8g}" for name, value in view.items()))


if __name__ == "__main__":
    main()
