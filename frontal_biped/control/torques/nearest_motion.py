r"""The walking program where limits are active: a point of a polyhedron, nearest to the origin, in four dimensions.

The program (`walking_qp`) misses its four targets by the residuals

.. math:: r = ((\ddot y - v) / a_0,\; (N_0 - p_{FRI} F_v) / T_0),

and its cost is |r|^2 / 2. Accelerations and forces are affine in r (`linearisation`); r = 0 is the linearising motion.
What remains are the limits, rows G'r >= h: a least-distance problem, which `least_distance` solves exactly, in a few
small steps, or shows to have no solution.

**With a control Lyapunov function** r is measured from v = 0 and the condition of decrease is one more row. Its
relaxation delta has the price rho: where the multiplier of the row is at most rho, delta is zero; otherwise the row
pulls with rho exactly, which is the same program without the row and with v = -rho a_0 n.

**Where no torques keep every limit** the limits give way as `relaxation` says: the least overstepping s is a
least-distance problem too, and a second one has the limits moved by s.
"""

from math import isfinite
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dposv

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limits import JointLimits
from frontal_biped.control.torques.linearisation import (
    BODY_JOINTS,
    FRI,
    JOINTS,
    N_0,
    Motion,
    StanceDynamics,
    Targets,
)
from frontal_biped.control.torques.relaxation import Overstepping, weights
from frontal_biped.control.torques.walking_qp import ANKLE, FORCE, FORCES, OUTPUT_ACCELERATION, VARIABLES, U, WalkingQp
from frontal_biped.model.biped import BASE
from frontal_biped.model.state import State
from frontal_biped.numerics.least_distance import NoFeasiblePointError, UndecidedError, nearest_point_of
from frontal_biped.numerics.quadratic_program import UNBOUNDED

EXACT = 1e-9
"""By how much a row may be missed, in the units of the program."""

NEVER = -1e9
"""Stands for minus infinity: a row that is never active."""


STEEP = 1e8
"""Norm of the accelerations by the residuals [rad/s^2], above which I_P nearly vanishes: the linearising motion is as
large, and what is left of it when the limits are kept has lost as many digits."""


class Nearest(NamedTuple):
    """The optimum of the walking program.

    Attributes:
        motion: accelerations and forces.
        relaxation: delta of the control Lyapunov function [rad/s^2].
        violation: by how much limits are overstepped, in the units of the program [-]; 0 where none had to give way.
    """

    motion: Motion
    relaxation: float
    violation: float


class NearestMotion:
    """Solves the walking program in the residuals of its targets.

    Args:
        qp: the program; its limits are used, and its units.

    Attributes:
        joints: limits of the joints' motion, or None.
        torque_unit: of the FRI's residual, T_0 [N m].
        of_forces: (k, 7) rows of the limits, in the units of the program, of the forces.
        of_ddq: (k, 4) of the accelerations.
        fixed: lower bounds of those of them that are the same at every tick; the joints' come behind.
    """

    def __init__(self, qp: WalkingQp) -> None:
        self.joints, self._price, self.torque_unit = qp.limits.joints, qp.price, qp.torque_unit
        forces, least, weight = _rows_of_forces(qp)
        limited = np.zeros(0, np.intp) if self.joints is None else self.joints.limited
        joint = np.eye(JOINTS)[limited] / OUTPUT_ACCELERATION
        self.fixed, self._limited = least, limited.tolist()
        self._fixed = least.tolist()
        self.of_forces = np.concatenate([forces, np.zeros((2 * len(joint), BASE + JOINTS))])
        self.of_ddq = np.concatenate([np.zeros((len(forces), JOINTS)), joint, -joint])
        # of the forces, and of the accelerations behind them where any row is of these
        self._rows = self.of_forces if self.joints is None else np.hstack([self.of_forces, self.of_ddq])
        self._columns = np.ascontiguousarray(self._rows.T)
        self._overstepping = Overstepping(np.concatenate([weight, 2 * list(weights(qp.rows)[qp.rows.joint][limited])]))

    def solve(self, dynamics: StanceDynamics, targets: Targets, linearising: Motion) -> Nearest | None:
        """The optimum at the state of the dynamics.

        None where it is not known to rounding: I_P nearly vanishes, or the state is far outside of everything.

        Args:
            dynamics: at the state.
            targets: what is asked of it.
            linearising: the motion that meets them, limits left aside.
        """
        origin = linearising
        if targets.decrease is not None:  # from v = 0
            origin = dynamics.linearising(targets._replace(ddy=np.zeros(BODY_JOINTS))) or linearising
        along = dynamics.along_residuals(targets, OUTPUT_ACCELERATION, self.torque_unit)
        forces_along = dynamics.M[:, BASE:].dot(along)
        G, h = self._limits(dynamics.state, origin, along, forces_along)
        if not (isfinite(h.dot(h)) and np.vdot(along, along) < STEEP * STEEP):
            return None
        try:
            r, delta, violation = self._optimum_or_nearest(G, h, targets)
        except NoFeasiblePointError:
            return None
        ddq, forces = along.dot(r), forces_along.dot(r)
        ddq += origin.ddq
        forces += origin.forces
        return Nearest(Motion(ddq, forces), delta, violation)

    def _optimum_or_nearest(self, G: FloatArray, h: FloatArray, targets: Targets) -> tuple[FloatArray, float, float]:
        """Residuals (4,), delta [rad/s^2] and violation [-]: with the limits as they are, or giving way as they must.

        Raises:
            NoFeasiblePointError: neither is known to rounding.
        """
        try:
            return *self._optimum(G, h, targets), 0.0
        except UndecidedError:
            raise
        except NoFeasiblePointError:
            r, delta = self._optimum(G, h - self._least_overstepping(G, h, targets), targets)
            return r, delta, max(0.0, _largest(h - r.dot(G)))

    def _limits(
        self, state: State, origin: Motion, along: FloatArray, forces_along: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Rows G'r >= h of all limits, G (4, k), h (k,)."""
        if self.joints is None:
            return forces_along.T.dot(self._columns), self.fixed - self._rows.dot(origin.forces)
        G = np.concatenate([forces_along, along]).T.dot(self._columns)
        h = self._least(self.joints, state) - self._rows.dot(np.concatenate([origin.forces, origin.ddq]))
        return G, np.maximum(h, NEVER, out=h)

    def _least(self, joints: JointLimits, state: State) -> FloatArray:
        """(k,) lower bounds of the rows at a state; -inf of a joint without a limit on that side."""
        ranges = joints.ranges_at(state)
        lower = [ranges[joint][0] / OUTPUT_ACCELERATION for joint in self._limited]
        upper = [ranges[joint][1] / -OUTPUT_ACCELERATION for joint in self._limited]
        return np.array(self._fixed + lower + upper)

    def _optimum(self, G: FloatArray, h: FloatArray, targets: Targets) -> tuple[FloatArray, float]:
        """Residuals (4,) and delta [rad/s^2] of the optimum under G'r >= h.

        Raises:
            NoFeasiblePointError: there is none.
            UndecidedError: it is not known to rounding.
        """
        if targets.decrease is None:
            return _nearest(G, h)[0], 0.0
        n, b = targets.decrease
        row = np.append(-n, 0.0)
        try:
            r, multipliers = _nearest(np.column_stack([G, row]), np.append(h, b / OUTPUT_ACCELERATION))
            if multipliers[-1] <= self._price:
                return r, 0.0
        except NoFeasiblePointError:  # not without relaxation
            pass
        pulled = self._price * row
        r = _nearest(G, h - pulled.dot(G))[0] + pulled
        delta = b - OUTPUT_ACCELERATION * row.dot(r).item()
        if delta < 0.0:
            raise UndecidedError("neither with nor without relaxation")
        return r, delta

    def _least_overstepping(self, G: FloatArray, h: FloatArray, targets: Targets) -> FloatArray:
        """(k,) by how much each limit gives way, a little more than it must.

        Raises:
            NoFeasiblePointError: rounding makes it look as if motors had to give way too.
        """
        if targets.decrease is not None:
            h = h - targets.ddy.dot(G[:FRI]) / OUTPUT_ACCELERATION
        return self._overstepping.least(G, h, _distance(G, h))


def _rows_of_forces(qp: WalkingQp) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows (k, 7) of the limits of contact and motors by the forces, their least values (k,), their weights (k,).

    The program has no N_0 among its variables. Its rows of the contact have it as the combination that it is of
    others, and nothing else of the torques, so that the ankle's tells how much of it they have.
    """
    contact, torque, *_ = qp.rows
    program, fixed = qp.fixed, slice(contact.start, torque.stop)
    C, l, u = program.C[fixed, :VARIABLES].copy(), program.l[fixed].copy(), program.u[fixed].copy()
    moment = np.zeros(len(C))
    moment[contact] = C[contact, ANKLE]
    C -= np.outer(moment, qp.moment)
    l += moment * qp.moment_constant
    C /= qp.scale
    rows = np.zeros((len(C), BASE + JOINTS))
    rows[:, :FORCES], rows[:, N_0], rows[:, BASE:] = C[:, FORCE], moment / qp.torque_unit, C[:, U]
    below, above, weight = l > -UNBOUNDED, u < UNBOUNDED, weights(qp.rows)[fixed]
    return (
        np.concatenate([rows[below], -rows[above]]),
        np.concatenate([l[below], -u[above]]),
        np.concatenate([weight[below], weight[above]]),
    )


def _nearest(G: FloatArray, h: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The point r (4,) nearest to the origin with G'r >= h, and multipliers (k,).

    It is sought in units of the distance that the farthest row asks for, or rounding would hide a far one.

    Raises:
        NoFeasiblePointError: there is none.
        UndecidedError: it is not known to rounding.
    """
    unit = _distance(G, h)
    E = np.empty((JOINTS + 1, len(h)))
    E[:JOINTS] = G
    np.divide(h, unit, out=E[JOINTS])
    multipliers = nearest_point_of(E)
    multipliers *= unit
    r = G.dot(multipliers)
    missed = h - r.dot(G)
    for shortest in (_by_normal_equations, _by_least_squares):  # the second is sought where the first is too rough
        if _roughness(missed, multipliers) <= EXACT:
            return r, multipliers
        active = multipliers.nonzero()[0]
        r += shortest(G.take(active, 1), missed.take(active))
        missed = h - r.dot(G)
    if _roughness(missed, multipliers) > EXACT:
        raise UndecidedError("the active rows are met to rounding only")
    return r, multipliers


def _by_normal_equations(rows: FloatArray, values: FloatArray) -> FloatArray:
    """Shortest d (4,) with rows'd = values; zero where the rows are dependent."""
    _, weights, failed = dposv(rows.T.dot(rows), values)
    return np.zeros(len(rows)) if failed else np.asarray(rows.dot(weights))


def _by_least_squares(rows: FloatArray, values: FloatArray) -> FloatArray:
    """The same by singular values: slower, for rows however nearly dependent."""
    return np.asarray(np.linalg.lstsq(rows.T, values, rcond=None)[0], dtype=float)


def _roughness(missed: FloatArray, multipliers: FloatArray) -> float:
    """By how much h - G'r is positive anywhere, or not zero where a row is active."""
    amounts = missed.tolist()  # plain numbers, as `tracking`
    roughness = max(amounts)
    for amount, multiplier in zip(amounts, multipliers.tolist(), strict=True):
        if multiplier and amount < -roughness:
            roughness = -amount
    return roughness


def _largest(values: FloatArray) -> float:
    """Of a handful of numbers; NumPy's own `max` takes four times as long to begin."""
    return values.item(values.argmax())


def _distance(G: FloatArray, h: FloatArray) -> float:
    """How far r must at least go to meet the row G'r >= h that is missed by most, or 1 if that is more."""
    i = h.argmax()
    row = G[:, i]
    size = row.dot(row).item() ** 0.5
    return max(1.0, h.item(i) / size) if size > 0.0 else 1.0
