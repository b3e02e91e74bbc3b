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
        """(..., m, 7) F_h, F_v [N], N_0, u_1..u_4 [N m] of motions with the stance foot at rest, as for one state.

        Args:
            q: (m, 4) [rad].
            dq: (m, 4) [rad/s].
            ddq: (m, 4) accelerations, or (k, m, 4) several at each of the states [rad/s^2].
        """
        states = zip((self._foot, self._still, self._still), (q, dq, ddq), strict=True)
        forces = _rows(pin.rneaInParallel, self._on_foot, *(_behind(foot, at, ddq.shape) for foot, at in states))
        return forces.reshape(*ddq.shape[:-1], -1)


def _behind(foot: FloatArray, joints: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """(m, b + 4) the same (b,) before every row of (..., m, 4), which is repeated to a shape (.., 4) first."""
    b = len(foot)
    rows = np.empty((*shape[:-1], b + shape[-1]))
    rows[..., :b], rows[..., b:] = foot, joints
    return rows.reshape(-1, b + shape[-1])


def _rows(function: object, pool: pin.ModelPool, *arrays: FloatArray) -> FloatArray:
    """What a function of columns makes of rows (m, n)."""
    count = len(arrays[0])
    if count == 1:  # of a single column Pinocchio's binding mistakes the shape
        arrays = tuple(np.repeat(array, 2, axis=0) for array in arrays)
    columns = (np.ascontiguousarray(array).T for array in arrays)  # Fortran order, as Pinocchio wants them
    found: FloatArray = function(1, pool, *columns).T[:count]  # type: ignore[operator]
    return found
