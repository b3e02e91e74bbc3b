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

from itertools import compress
from math import isfinite, sqrt
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

FAR = 100.0
"""By how much a row must be missed for the nearest point to be far, in the units of the program."""

AMPLE = 1e9
"""Stands for infinite room: a row that is never active."""
ROOM = JOINTS
"""Place of -h, the room that a row has at r = 0, below the four of G; and of the 1 behind r."""


class Nearest(NamedTuple):
    """The optimum of the walking program.

    Attributes:
        ddq: (4,) accelerations [rad/s^2].
        forces: (7,) of `Motion` [N, N m].
        relaxation: delta of the control Lyapunov function [rad/s^2].
        violation: by how much limits are overstepped, in the units of the program [-]; 0 where none had to give way.
    """

    ddq: FloatArray
    forces: FloatArray
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
        self.fixed, self._fixed, self._limited = least, least.tolist(), limited.tolist()
        self.of_forces = np.concatenate([forces, np.zeros((2 * len(joint), BASE + JOINTS))])
        self.of_ddq = np.concatenate([np.zeros((len(forces), JOINTS)), joint, -joint])
        # of the forces, and of the accelerations behind them where any row is of these
        self._rows = self.of_forces if self.joints is None else np.hstack([self.of_forces, self.of_ddq])
        self._columns = np.ascontiguousarray(self._rows.T)
        of_joints = weights(qp.rows)[qp.rows.joint][limited]
        self._overstepping = Overstepping(np.concatenate([weight, of_joints, of_joints]))

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
        motion = dynamics.by_residuals(targets, OUTPUT_ACCELERATION, self.torque_unit, origin.ddq)
        if motion is None:
            return None
        forces = dynamics.M[:, BASE:].dot(motion)  # both of (r, 1)
        forces[:, JOINTS] = origin.forces
        rows = self._limits(dynamics.state, motion, forces)
        try:
            r, delta = self._optimum(rows, targets)
            violation = 0.0
        except UndecidedError:
            return None
        except NoFeasiblePointError:
            try:
                r, delta, violation = self._giving_way(rows, targets)
            except NoFeasiblePointError:
                return None
        return Nearest(motion.dot(r), forces.dot(r), delta, violation)

    def _giving_way(self, rows: FloatArray, targets: Targets) -> tuple[FloatArray, float, float]:
        """(r, 1), delta [rad/s^2] and violation [-] with limits that give way as they must.

        Raises:
            NoFeasiblePointError: it is not known to rounding.
        """
        moved = rows.copy()
        moved[ROOM] += self._least_overstepping(rows, targets)
        r, delta = self._optimum(moved, targets)
        return r, delta, max(0.0, -min(r.dot(rows).tolist()))

    def _limits(self, state: State, motion: FloatArray, forces: FloatArray) -> FloatArray:
        """(5, k) all limits, rows'(r, 1) >= 0, of accelerations (4, 5) and forces (7, 5) by (r, 1)."""
        if self.joints is None:
            rows, least = forces.T.dot(self._columns), self.fixed
        else:
            rows, least = np.concatenate([forces, motion]).T.dot(self._columns), self._least(self.joints, state)
        room = rows[ROOM]
        room -= least
        return rows

    def _least(self, joints: JointLimits, state: State) -> FloatArray:
        """(k,) lower bounds of the rows at a state."""
        bounds = joints.bounds_of_joints(state)
        least = [*self._fixed]
        least += [max(bounds[i][0] / OUTPUT_ACCELERATION, -AMPLE) for i in self._limited]
        least += [max(bounds[i][1] / -OUTPUT_ACCELERATION, -AMPLE) for i in self._limited]
        return np.fromiter(least, float, len(least))

    def _optimum(self, rows: FloatArray, targets: Targets) -> tuple[FloatArray, float]:
        """(r, 1) and delta [rad/s^2] of the optimum under rows'(r, 1) >= 0.

        Raises:
            NoFeasiblePointError: there is none.
            UndecidedError: it is not known to rounding.
        """
        if targets.decrease is None:
            return _nearest(rows)[0], 0.0
        n, b = targets.decrease
        decrease = np.array((*(-n).tolist(), 0.0, -b / OUTPUT_ACCELERATION))
        try:
            r, multipliers = _nearest(np.column_stack([rows, decrease]))
            if multipliers[-1] <= self._price:
                return r, 0.0
        except NoFeasiblePointError:  # not without relaxation
            pass
        pulled = self._price * decrease
        pulled[ROOM] = 0.0
        moved = rows.copy()
        moved[ROOM] += pulled.dot(rows)
        r = _nearest(moved)[0]
        r += pulled
        delta = b + OUTPUT_ACCELERATION * n.dot(r[:FRI]).item()
        if delta < 0.0:
            raise UndecidedError("neither with nor without relaxation")
        return r, delta

    def _least_overstepping(self, rows: FloatArray, targets: Targets) -> FloatArray:
        """(k,) by how much each limit gives way, a little more than it must.

        Raises:
            NoFeasiblePointError: rounding makes it look as if motors had to give way too.
        """
        if targets.decrease is not None:
            rows = rows.copy()
            rows[ROOM] += targets.ddy.dot(rows[:FRI]) / OUTPUT_ACCELERATION
        return self._overstepping.least(rows, _distance(rows))


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


def _nearest(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(r, 1) of the point r nearest to the origin with rows'(r, 1) >= 0, rows (5, k), and multipliers (k,).

    A far one is sought in units of the distance that the farthest row asks for, or rounding would hide it.

    Raises:
        NoFeasiblePointError: there is none.
        UndecidedError: it is not known to rounding.
    """
    unit = _unit(rows)
    scaled = rows
    if unit > 1.0:
        scaled = rows.copy()
        scaled[ROOM] /= unit
    multipliers = nearest_point_of(scaled, unit)
    r = rows.dot(multipliers)
    r[ROOM] = 1.0
    room = r.dot(rows)
    for shortest in (_by_normal_equations, _by_least_squares):  # the second is sought where the first is too rough
        if _missed(room, multipliers) <= EXACT:
            return r, multipliers
        active = multipliers.nonzero()[0]
        r[:ROOM] -= shortest(rows[:ROOM].take(active, 1), room.take(active))
        room = r.dot(rows)
    if _missed(room, multipliers) > EXACT:
        raise UndecidedError("the active rows are met to rounding only")
    return r, multipliers


def _by_normal_equations(G: FloatArray, values: FloatArray) -> FloatArray:
    """Shortest d (4,) with G'd = values; zero where the rows are dependent."""
    _, weights, failed = dposv(G.T.dot(G), values)
    return np.zeros(len(G)) if failed else np.asarray(G.dot(weights))


def _by_least_squares(G: FloatArray, values: FloatArray) -> FloatArray:
    """The same by singular values: slower, for rows however nearly dependent."""
    return np.asarray(np.linalg.lstsq(G.T, values, rcond=None)[0], dtype=float)


def _missed(room: FloatArray, multipliers: FloatArray) -> float:
    """By how much G'r - h is negative anywhere, or not zero where a row is active."""
    amounts = room.tolist()  # plain numbers, as `tracking`
    missed = -min(amounts)
    for amount in compress(amounts, multipliers.tolist()):
        if amount > missed:
            missed = amount
    return missed


def _unit(rows: FloatArray) -> float:
    """The distance where a row is missed by `FAR` or more; 1 where none is.

    Raises:
        UndecidedError: one of them is not a finite number.
    """
    room = rows[ROOM].tolist()
    if not isfinite(sum(room)):
        raise UndecidedError("the state is far outside of everything")
    return 1.0 if min(room) > -FAR else _distance(rows)


def _distance(rows: FloatArray) -> float:
    """How far r must at least go to meet the row that is missed by most, or 1 if that is more."""
    a, b, c, d, room = rows[:, rows[ROOM].argmin()].tolist()
    size = sqrt(a * a + b * b + c * c + d * d)
    return max(1.0, -room / size) if size > 0.0 else 1.0
