"""The residuals nearest to zero that keep all limits, found by `least_distance` and proved here.

Limits are the columns of a matrix (5, k), G above the room that they have at r = 0: rows'(r, 1) >= 0. A point that
keeps every row, meets some of them, and is a sum of these with multipliers that are not negative is the nearest one:
these conditions are sufficient. The first two are verified to `EXACT`, and where rounding has left more, the rows found
active are solved for once more.
"""

from itertools import compress
from math import isfinite, sqrt

import numpy as np
from scipy.linalg.lapack import dposv

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.linearisation import JOINTS
from frontal_biped.numerics.least_distance import UndecidedError, nearest_point_of

EXACT = 1e-9
"""By how much a row may be missed, in the units of the program."""

FAR = 100.0
"""By how much a row must be missed for the nearest point to be far, in the units of the program."""

ROOM = JOINTS
"""Place of the room in the rows, below the four of G; and of the 1 behind r."""

TARGETS_MET = np.array([0.0] * JOINTS + [1.0])
"""(r, 1) where no row is missed; read-only."""
TARGETS_MET.flags.writeable = False


def nearest_residuals(rows: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(r, 1) of the point r nearest to the origin with rows'(r, 1) >= 0, rows (5, k), and multipliers (k,).

    `TARGETS_MET` itself where that is the origin.

    A far one is sought in units of the distance that the farthest row asks for, or rounding would hide it.

    Raises:
        NoFeasiblePointError: there is none.
        UndecidedError: it is not known to rounding.
    """
    least_room = _least_room(rows)
    if least_room >= 0.0:
        return TARGETS_MET, np.zeros(rows.shape[1])
    unit, scaled = 1.0, rows
    if least_room <= -FAR:
        unit, scaled = distance(rows), rows.copy()
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


def _least_room(rows: FloatArray) -> float:
    """What the row that is missed by most leaves at r = 0.

    Raises:
        UndecidedError: the room of one of them is not a finite number.
    """
    room = rows[ROOM].tolist()
    if not isfinite(sum(room)):
        raise UndecidedError("the state is far outside of everything")
    return min(room)


def distance(rows: FloatArray) -> float:
    """How far r must at least go to meet the row that is missed by most, or 1 if that is more."""
    a, b, c, d, room = rows[:, rows[ROOM].argmin()].tolist()
    size = sqrt(a * a + b * b + c * c + d * d)
    return max(1.0, -room / size) if size > 0.0 else 1.0
