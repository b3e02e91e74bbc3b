"""Dynamics of the biped at many states in one call: the loop over them is Pinocchio's, in C++, on one thread.

Row by row it is what `FrontalBiped` answers for one state. Rows are states, as in every recording.
"""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray


class ManyStates:
    """Dynamics at many states; owns Pinocchio work data and is not thread-safe.

    Args:
        pinned: model of the four moving links, stance foot fixed.
        planar_base: model of all five links, the stance foot on a planar joint.
    """

    def __init__(self, pinned: pin.Model, planar_base: pin.Model) -> None:
        self._pinned, self._on_foot = pin.ModelPool(pinned, 1), pin.ModelPool(planar_base, 1)
        # configuration and freedoms of the stance foot at rest, which come first
        self._foot, self._still = pin.neutral(planar_base)[: -pinned.nq], np.zeros(planar_base.nv - pinned.nv)

    def forward_dynamics(self, q: FloatArray, dq: FloatArray, u: FloatArray) -> FloatArray:
        """(m, 4) ddq [rad/s^2] at q, dq (m, 4) under the torques u (m, 4) [N m], stance foot held."""
        return _rows(pin.abaInParallel, self._pinned, q, dq, u)

    def inverse_dynamics(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        """(m, 7) F_h, F_v [N], N_0 [N m], u_1..u_4 [N m] of motions with the stance foot at rest, as for one state."""
        states = zip((self._foot, self._still, self._still), (q, dq, ddq), strict=True)
        return _rows(pin.rneaInParallel, self._on_foot, *(_behind(foot, joints) for foot, joints in states))


def _behind(foot: FloatArray, joints: FloatArray) -> FloatArray:
    """(m, b + 4) the same (b,) before every row of (m, 4)."""
    rows = np.empty((len(joints), len(foot) + joints.shape[1]))
    rows[:, : len(foot)], rows[:, len(foot) :] = foot, joints
    return rows


def _rows(function: object, pool: pin.ModelPool, *arrays: FloatArray) -> FloatArray:
    """What a function of columns makes of rows (m, n)."""
    count = len(arrays[0])
    if count == 1:  # of a single column Pinocchio's binding mistakes the shape
        arrays = tuple(np.repeat(array, 2, axis=0) for array in arrays)
    columns = (np.ascontiguousarray(array).T for array in arrays)  # Fortran order, as Pinocchio wants them
    found: FloatArray = function(1, pool, *columns).T[:count]  # type: ignore[operator]
    return found
