r"""The whole-body program where limits are active: the nearest point of a polyhedron, exactly.

The motion is affine in the weighted residuals r of the rows (`motion`), and the cost is |r|^2/2. What remains are the
limits, rows G r >= h: a least-distance problem, as in the plane (`torques.nearest_motion`). Of some hundred and thirty
rows a handful is active: rows are taken in as they are found violated.

Where no motion keeps every limit, ranges and speeds of the joints are left aside and the standing foot may be missed,
at a high price. What is left always has a solution: no torque at all, and any wrench that the contact can carry.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.whole_body.limits import CONTACT, Bounds
from frontal_biped.control.whole_body.motion import Motion
from frontal_biped.control.whole_body.tasks import WRENCH
from frontal_biped.model.space.free_robot import BASE
from frontal_biped.numerics.least_distance import UndecidedError, nearest_point, polished

EXACT = 1e-9
"""By how much a row may be missed, in units of the limit or of `ACCELERATION` [-]."""

ACCELERATION = 100.0
"""Unit of accelerations in rows [rad/s^2]."""

ROUNDS = 12
"""How often rows are taken in before all of them are."""


class Polyhedron(NamedTuple):
    """Rows G r >= h.

    Attributes:
        G: (k, residuals).
        h: (k,).
    """

    G: FloatArray
    h: FloatArray

    def nearest(self) -> tuple[FloatArray, FloatArray]:
        """The point nearest to the origin, and the multipliers (k,) of all rows.

        Raises:
            NoFeasiblePointError: it is empty, or rounding does not let tell.
        """
        G, h = self
        multipliers = np.zeros(len(h))
        taken = h > EXACT
        for _ in range(ROUNDS):
            columns, least = G[taken].T, h[taken]
            found = polished(columns, least, nearest_point(columns, least))
            r = columns @ found
            missed = (h - G @ r > EXACT) & ~taken
            if not missed.any():
                multipliers[taken] = found
                return r, multipliers
            taken |= missed
        raise UndecidedError("rows do not stop being missed")


class LimitRows:
    """Writes the limits as rows in the residuals.

    Args:
        effort: (n,) torque limits [N m].
        weight: of the robot [N].
    """

    def __init__(self, effort: FloatArray, weight: float) -> None:
        self._effort, self._weight, n = effort, weight, len(effort)
        self._n = n
        self._G: dict[int, FloatArray] = {}

    def at(
        self, motion: Motion, along: Motion, contact: FloatArray, floor: FloatArray, bounds: Bounds | None
    ) -> Polyhedron:
        """The rows at a tick.

        Args:
            motion: that meets every row.
            along: columns, by the residuals that may be missed.
            contact: (11, 6) rows of the contact.
            floor: (11,) what they are at least [N, N m].
            bounds: of the joints' accelerations; None: left aside.
        """
        n, effort, weight = self._n, self._effort, self._weight
        columns = along.x.shape[1]
        size = CONTACT + 2 * n + (0 if bounds is None else 2 * n)
        G = self._G.get(size)
        if G is None or G.shape[1] != columns:
            G = self._G[size] = np.zeros((size, columns))
        h = np.empty(size)
        wrench = contact / weight
        np.dot(wrench, along.x[-WRENCH:], out=G[:CONTACT])
        h[:CONTACT] = floor / weight - wrench @ motion.x[-WRENCH:]
        up, down = slice(CONTACT, CONTACT + n), slice(CONTACT + n, CONTACT + 2 * n)
        np.divide(along.tau, effort[:, None], out=G[up])
        np.negative(G[up], out=G[down])
        used = motion.tau / effort
        h[up], h[down] = -1.0 - used, used - 1.0
        if bounds is not None:
            up, down = slice(down.stop, down.stop + n), slice(down.stop + n, size)
            np.divide(along.x[BASE:-WRENCH], ACCELERATION, out=G[up])
            np.negative(G[up], out=G[down])
            joints = motion.x[BASE:-WRENCH]
            h[up], h[down] = (bounds.lower - joints) / ACCELERATION, (joints - bounds.upper) / ACCELERATION
        return Polyhedron(G, h)
