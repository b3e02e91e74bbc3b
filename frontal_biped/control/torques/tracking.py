r"""Errors of the outputs, and the accelerations that let them die out, in plain numbers.

At a rate x' of the phase's variable, beta or the sway,

.. math:: y = q_b - h_d, \qquad \dot y = \dot q_b - h_d'\, x', \qquad v = -\omega^2 y - 2 d\, \omega\, \dot y,

and the body joints' accelerations that give the outputs v are a + c x'' with a = v + h_d'' x'^2, c = h_d'. On three
joints every call of NumPy costs more than the arithmetic of a whole line here.
"""

from typing import NamedTuple

import numpy as np

from frontal_biped.arrays import FloatArray


class Tracked(NamedTuple):
    """Outputs at one state.

    Attributes:
        line: (2, 4) accelerations of all joints for outputs over beta, a [rad/s^2] and c [-], the ankle's being beta's.
        y: (3,) output [rad].
        dy: (3,) its rate [rad/s].
        ddy: (3,) acceleration v that is asked of it [rad/s^2].
        curve: (3,) h_d'' x'^2 [rad/s^2].
    """

    line: FloatArray
    y: FloatArray
    dy: FloatArray
    ddy: FloatArray
    curve: FloatArray


class ErrorDynamics:
    """How the outputs' errors are to die out.

    Args:
        frequency: omega [rad/s].
        damping: d, ratio [-].
    """

    def __init__(self, frequency: float, damping: float) -> None:
        self._pull, self._drag = -(frequency**2), -2.0 * damping * frequency

    def asked(self, y: FloatArray, dy: FloatArray) -> FloatArray:
        """v [rad/s^2] of outputs y [rad] and dy [rad/s], of one shape."""
        return self._drag * dy + self._pull * y

    def at(
        self, q: FloatArray, dq: FloatArray, rate: float, h_d: FloatArray, h_d1: FloatArray, h_d2: FloatArray
    ) -> Tracked:
        """Outputs at q (4,) [rad], dq (4,) [rad/s].

        Args:
            q: joint angles, the stance ankle's first.
            dq: their rates.
            rate: x' of the phase's variable, of beta [rad/s] or of the sway [m/s].
            h_d: (3,) wanted body coordinates [rad].
            h_d1: (3,) their derivative with respect to x.
            h_d2: (3,) their second derivative.
        """
        pull, drag, square = self._pull, self._drag, rate**2
        _, q_1, q_2, q_3 = q.tolist()
        _, dq_1, dq_2, dq_3 = dq.tolist()
        h_1, h_2, h_3 = h_d.tolist()
        c_1, c_2, c_3 = h_d1.tolist()
        b_1, b_2, b_3 = h_d2.tolist()
        b_1, b_2, b_3 = b_1 * square, b_2 * square, b_3 * square
        y_1, y_2, y_3 = q_1 - h_1, q_2 - h_2, q_3 - h_3
        dy_1, dy_2, dy_3 = dq_1 - rate * c_1, dq_2 - rate * c_2, dq_3 - rate * c_3
        v_1, v_2, v_3 = drag * dy_1 + pull * y_1, drag * dy_2 + pull * y_2, drag * dy_3 + pull * y_3
        # fmt: off
        numbers = (
            0.0, v_1 + b_1, v_2 + b_2, v_3 + b_3, 1.0, c_1, c_2, c_3,
            y_1, y_2, y_3, dy_1, dy_2, dy_3, v_1, v_2, v_3, b_1, b_2, b_3,
        )
        # fmt: on
        found = np.fromiter(numbers, float, len(numbers))  # faster than `np.array`
        return Tracked(found[:8].reshape(2, 4), found[8:11], found[11:14], found[14:17], found[17:])
