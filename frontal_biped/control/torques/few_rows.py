"""The ticks that are common, in one function of plain loops that Numba compiles: solver "compiled".

No limit active, or a few: then the active rows are guessed and the guess is proved (`few_active_rows`). What is not
found so is left to `nearest_motion`, which asks the same question and needs no compiler. NumPy takes half a microsecond
for every one of some twenty operations on a handful of numbers. Ticks 10 mrad off the gait, the same ones again and
again, took 5.5 us for this part where `nearest_motion` took 17, and 22 us in all where they took 41.
"""

from collections.abc import Callable
from functools import cache
from importlib import import_module

import numpy as np
import numpy.typing as npt

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.limit_rows import AMPLE
from frontal_biped.control.torques.linearisation import F_V, JOINTS, N_0, STEEP, Motion, StanceDynamics, Targets
from frontal_biped.control.torques.nearest_motion import NearestMotion
from frontal_biped.control.torques.nearest_residuals import EXACT
from frontal_biped.control.torques.walking_qp import OUTPUT_ACCELERATION
from frontal_biped.files.extras import missing_extra

NOT_FOUND, CLOSED_FORM, NEAREST = -1, 0, 1
"""Answers of `few_active_rows`."""

MOST_ACTIVE = 4
"""Rows that can be active in four dimensions without being dependent."""

GUESSES = 16
"""After which guessing is given up; guesses that lead anywhere are fewer."""


def few_active_rows(
    M: FloatArray,
    bias: FloatArray,
    line: FloatArray,
    of_outputs: FloatArray,
    p_fri: float,
    T_0: float,
    of_forces: FloatArray,
    of_ddq: FloatArray,
    least: FloatArray,
    joint: npt.NDArray[np.intp],
    rate: float,
    ranges: FloatArray,
    q: FloatArray,
    dq: FloatArray,
    ddq: FloatArray,
    forces: FloatArray,
) -> int:
    """The optimum of the walking program where it has few active rows.

    As in `nearest_motion` and with its symbols. The row that is missed most is taken up, one that pushes is let go.
    Nothing is assumed of the guess: a point that keeps every row, meets some of them, and is a sum of these with
    weights that are not negative is the nearest one, for the conditions of the optimum are sufficient here.

    Args:
        M: (7, 7) mass matrix.
        bias: (7,) Coriolis and gravity terms.
        line: (2, 4) `Targets.line`.
        of_outputs: (4, 4) `StanceDynamics.of_outputs`.
        p_fri: wanted FRI [m].
        T_0: unit of the FRI's residual [N m].
        of_forces: (k, 7) rows of the limits, of the forces.
        of_ddq: (k, 4) of the accelerations.
        least: their lower bounds, but for the last rows, which are of joints.
        joint: of which joint each of these rows is, first those of lower limits, then as many of upper ones.
        rate: r of the joints' limits [1/s].
        ranges: (3, 4) r^2 q_min, r^2 q_max, 2 r dq_max of every joint [rad/s^2].
        q: (4,) [rad].
        dq: (4,) [rad/s].
        ddq: (4,) place for the accelerations [rad/s^2].
        forces: (7,) place for the forces [N, N m].

    Returns:
        `CLOSED_FORM` with no row active, `NEAREST` with some, or `NOT_FOUND`: then ddq and forces are no answer.
    """
    base, n, fixed = 3, 4, len(least)
    rows = fixed + len(joint)
    # ------------------------------------------------------------------ the linearising motion
    m = np.empty(n)
    I_P = moment = 0.0
    for j in range(n):
        m[j] = M[N_0, base + j] - p_fri * M[F_V, base + j]
        moment += m[j] * line[0, j]
        I_P += m[j] * line[1, j]
    if I_P == 0.0:
        return NOT_FOUND
    x = -(moment + bias[N_0] - p_fri * bias[F_V]) / I_P
    for j in range(n):
        ddq[j] = line[0, j] + x * line[1, j]
    for i in range(len(forces)):
        forces[i] = bias[i]
        for j in range(n):
            forces[i] += M[i, base + j] * ddq[j]
    # ------------------------------------------------------------------ the limits: by how much each is missed
    h = np.empty(rows)
    most = 0
    for i in range(rows):
        if i < fixed:
            h[i] = least[i]
        else:  # as `JointLimits.bounds`
            which = joint[i - fixed]
            pull, drag = rate * rate * q[which], 2.0 * rate * dq[which]
            upper = min(ranges[1, which] - pull, ranges[2, which]) - drag
            lower = max(ranges[0, which] - pull, -ranges[2, which]) - drag
            h[i] = (min(lower, upper) if 2 * (i - fixed) < len(joint) else -upper) / OUTPUT_ACCELERATION
        for j in range(len(forces)):
            h[i] -= of_forces[i, j] * forces[j]
        for j in range(n):
            h[i] -= of_ddq[i, j] * ddq[j]
        if h[i] < -AMPLE:
            h[i] = -AMPLE
        if not np.isfinite(h[i]):
            return NOT_FOUND
        if h[i] > h[most]:
            most = i
    if h[most] <= 0.0:
        return CLOSED_FORM
    # ------------------------------------------------------------------ rows in the residuals, G r >= h
    along, steep = np.empty((n, n)), 0.0
    for j in range(n):
        k = T_0
        if j < n - 1:
            k = 0.0
            for i in range(n):
                k -= OUTPUT_ACCELERATION * m[i] * of_outputs[i, j]
        for i in range(n):
            along[i, j] = line[1, i] * k / I_P + OUTPUT_ACCELERATION * of_outputs[i, j]
            steep += along[i, j] * along[i, j]
    if not steep < STEEP * STEEP:
        return NOT_FOUND
    G = np.empty((rows, n))
    of_motion = np.empty(n)
    for i in range(rows):
        for j in range(n):
            of_motion[j] = of_ddq[i, j]
            for l in range(len(forces)):
                of_motion[j] += of_forces[i, l] * M[l, base + j]
        for j in range(n):
            G[i, j] = 0.0
            for l in range(n):
                G[i, j] += of_motion[l] * along[l, j]
    # ------------------------------------------------------------------ guesses
    active, weights = np.empty(MOST_ACTIVE, np.int64), np.empty(MOST_ACTIVE)
    L, r = np.empty((MOST_ACTIVE, MOST_ACTIVE)), np.empty(n)
    active[0] = most
    count = 1
    for _ in range(GUESSES):
        for i in range(count):  # G_a G_a' = L L'
            for j in range(i + 1):
                product = 0.0
                for l in range(n):
                    product += G[active[i], l] * G[active[j], l]
                for l in range(j):
                    product -= L[i, l] * L[j, l]
                if i > j:
                    L[i, j] = product / L[j, j]
                elif product > 0.0:
                    L[i, i] = np.sqrt(product)
                else:
                    return NOT_FOUND  # dependent
        for i in range(count):  # L L' weights = h_a
            weights[i] = h[active[i]]
            for l in range(i):
                weights[i] -= L[i, l] * weights[l]
            weights[i] /= L[i, i]
        for i in range(count - 1, -1, -1):
            for l in range(i + 1, count):
                weights[i] -= L[l, i] * weights[l]
            weights[i] /= L[i, i]
        kept = 0
        for i in range(count):
            if weights[i] >= 0.0:
                active[kept] = active[i]
                kept += 1
        if kept < count:
            if kept == 0:
                return NOT_FOUND
            count = kept
            continue
        for j in range(n):
            r[j] = 0.0
            for i in range(count):
                r[j] += weights[i] * G[active[i], j]
        missed, worst = -1, EXACT
        for i in range(rows):
            shortfall = h[i]
            for j in range(n):
                shortfall -= G[i, j] * r[j]
            if not shortfall <= worst:
                missed, worst = i, shortfall
        if missed >= 0:
            if count == MOST_ACTIVE:
                return NOT_FOUND
            active[count] = missed
            count += 1
            continue
        for i in range(count):  # met to rounding?
            room = -h[active[i]]
            for j in range(n):
                room += G[active[i], j] * r[j]
            if room > EXACT:
                return NOT_FOUND
        for i in range(n):
            of_motion[i] = 0.0
            for j in range(n):
                of_motion[i] += along[i, j] * r[j]
            ddq[i] += of_motion[i]
        for i in range(len(forces)):
            for j in range(n):
                forces[i] += M[i, base + j] * of_motion[j]
        return NEAREST
    return NOT_FOUND


@cache
def compiled() -> Callable[..., int]:
    """`few_active_rows`, compiled: some seconds the first time, and kept beside this file.

    Raises:
        MissingExtraError: Numba is not installed.
    """
    try:
        numba = import_module("numba")  # half a second, for those only who ask for it
    except ImportError:
        raise missing_extra("solver 'compiled' needs Numba", "compiled") from None
    function: Callable[..., int] = numba.njit(cache=True)(few_active_rows)
    return function


class FewRows:
    """Asks `few_active_rows` for the motion of a tick.

    Args:
        nearest: the program; its rows are used, and its units.
        function: compiled or not.
    """

    def __init__(self, nearest: NearestMotion, function: Callable[..., int]) -> None:
        self._rows, self._unit, self._function = nearest.rows, nearest.torque_unit, function
        joints = self._rows.joints
        limited = np.zeros(0, np.intp) if joints is None else joints.limited
        self._joint = np.concatenate([limited, limited])
        self._rate = 0.0 if joints is None else joints.rate
        self._ranges = np.zeros((3, JOINTS)) if joints is None else joints.ranges

    def solve(self, dynamics: StanceDynamics, targets: Targets) -> tuple[Motion, bool] | None:
        """The optimum at a state, and is a limit active? None: not found, or none of the program's outputs."""
        if targets.decrease is not None:
            return None
        rows = self._rows
        motion = Motion(np.empty(JOINTS), np.empty(len(dynamics.bias)))
        found = self._function(
            dynamics.M,
            dynamics.bias,
            targets.line(),
            targets.of_outputs(),
            targets.p_fri,
            self._unit,
            rows.of_forces,
            rows.of_ddq,
            rows.fixed,
            self._joint,
            self._rate,
            self._ranges,
            *dynamics.state,
            *motion,
        )
        return None if found == NOT_FOUND else (motion, found == NEAREST)
