r"""The walking program where limits are active: a point of a polyhedron, nearest to the origin, in four dimensions.

The program (`walking_qp`) misses its four targets by the residuals

.. math:: r = ((\ddot y - v) / a_0,\; (N_0 - p_{FRI} F_v) / T_0),

and its cost is |r|^2 / 2. Accelerations and forces are affine in r (`linearisation`); r = 0 is the linearising motion.
What remains are the limits (`limit_rows`): a least-distance problem, which `nearest_residuals` solves exactly, in a few
small steps, or shows to have no solution.

**With a control Lyapunov function** r is measured from v = 0 and the condition of decrease is one more row. Its
relaxation delta has the price rho: where the multiplier of the row is at most rho, delta is zero; otherwise the row
pulls with rho exactly, which is the same program without the row and with v = -rho a_0 n.

**Where no torques keep every limit** the limits give way as `relaxation` says: the least overstepping s is a
least-distance problem too, and a second one has the limits moved by s.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limit_rows import LimitRows
from frontal_biped.control.torques.linearisation import BODY_JOINTS, FRI, JOINTS, StanceDynamics, Targets
from frontal_biped.control.torques.nearest_residuals import ROOM, TARGETS_MET, distance, nearest_residuals
from frontal_biped.control.torques.relaxation import Overstepping
from frontal_biped.control.torques.walking_qp import OUTPUT_ACCELERATION, WalkingQp
from frontal_biped.model.biped import BASE
from frontal_biped.numerics.least_distance import NoFeasiblePointError, UndecidedError


class Nearest(NamedTuple):
    """The optimum of the walking program.

    Attributes:
        ddq: (4,) accelerations [rad/s^2].
        forces: (7,) of `Motion` [N, N m].
        relaxation: delta of the control Lyapunov function [rad/s^2].
        violation: by how much limits are overstepped, in the units of the program [-]; 0 where none had to give way.
        limited: does any limit or condition keep the targets from being met?
    """

    ddq: FloatArray
    forces: FloatArray
    relaxation: float
    violation: float
    limited: bool


class NearestMotion:
    """Solves the walking program in the residuals of its targets.

    Args:
        qp: the program; its limits are used, and its units.

    Attributes:
        rows: its limits.
        torque_unit: of the FRI's residual, T_0 [N m].
    """

    def __init__(self, qp: WalkingQp) -> None:
        self.rows, self.torque_unit, self._price = LimitRows(qp), qp.torque_unit, qp.price
        self._overstepping = Overstepping(self.rows.weight)

    def solve(self, dynamics: StanceDynamics, targets: Targets) -> Nearest | None:
        """The optimum at the state of the dynamics.

        None where it is not known to rounding: I_P nearly vanishes, or the state is far outside of everything.

        Args:
            dynamics: at the state.
            targets: what is asked of it.
        """
        asked = targets if targets.decrease is None else targets._replace(ddy=np.zeros(BODY_JOINTS))  # from v = 0
        motion = dynamics.by_residuals(asked, OUTPUT_ACCELERATION, self.torque_unit)
        if motion is None:
            return None
        forces = dynamics.M[:, BASE:].dot(motion)  # both of (r, 1)
        forces[:, JOINTS] += dynamics.bias
        rows = self.rows.at(dynamics.state, motion, forces)
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
        return Nearest(motion.dot(r), forces.dot(r), delta, violation, r is not TARGETS_MET)

    def _giving_way(self, rows: FloatArray, targets: Targets) -> tuple[FloatArray, float, float]:
        """(r, 1), delta [rad/s^2] and violation [-] with limits that give way as they must.

        Raises:
            NoFeasiblePointError: it is not known to rounding.
        """
        moved = rows.copy()
        moved[ROOM] += self._least_overstepping(rows, targets)
        r, delta = self._optimum(moved, targets)
        return r, delta, max(0.0, -min(r.dot(rows).tolist()))

    def _optimum(self, rows: FloatArray, targets: Targets) -> tuple[FloatArray, float]:
        """(r, 1) and delta [rad/s^2] of the optimum under rows'(r, 1) >= 0.

        Raises:
            NoFeasiblePointError: there is none.
            UndecidedError: it is not known to rounding.
        """
        if targets.decrease is None:
            return nearest_residuals(rows)[0], 0.0
        n, b = targets.decrease
        decrease = np.array((*(-n).tolist(), 0.0, -b / OUTPUT_ACCELERATION))
        try:
            r, multipliers = nearest_residuals(np.column_stack([rows, decrease]))
            if multipliers[-1] <= self._price:
                return r, 0.0
        except NoFeasiblePointError:  # not without relaxation
            pass
        pulled = self._price * decrease
        pulled[ROOM] = 0.0
        moved = rows.copy()
        moved[ROOM] += pulled.dot(rows)
        r = nearest_residuals(moved)[0]
        r = r + pulled  # it may be read-only
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
        return self._overstepping.least(rows, distance(rows))
