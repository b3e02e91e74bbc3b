"""The input-output linearising torque in closed form, with the FRI on its target.

The accelerations that give the output the acceleration asked for are a line, ddq = a + c ddbeta with a = (0, v + h_d''
dbeta^2) and c = (1, h_d'). The generalised forces along it are W = M a + bias + M c ddbeta, with M and bias of the
floating model held still, W = (F_h, F_v, N_0, u); its rows F_v and N_0 give the one unknown left from N_0 = p_FRI F_v.
The divisor, (M c)_N - p_FRI (M c)_F, is I_P on Z, and zero exactly where the decoupling matrix is singular (C03).

A motion that misses its targets by ddy - v = a_0 r_1..3, N_0 - p_FRI F_v = T_0 r_4 is affine in the residuals r, with
m = M_N - p_FRI M_F and I_P = m c:

    dddbeta/dr = k = (-a_0 m_b, T_0) / I_P,    dddq/dr = c k' + a_0 [0 0; I 0],    dW/dr = M dddq/dr
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.lyapunov import Decrease
from frontal_biped.model.biped import BASE, FrontalBiped


class Targets(NamedTuple):
    """What the controller asks of one instant.

    Attributes:
        h_d1: (3,) dh_d/dbeta [-].
        h_d2_dbeta2: (3,) h_d'' dbeta^2 [rad/s^2].
        ddy: (3,) wanted output acceleration v [rad/s^2].
        p_fri: wanted FRI [m].
        decrease: with a control Lyapunov function, the condition whose least v is ``ddy``; None without.
        relaxation: delta of that v [rad/s^2].
    """

    h_d1: FloatArray
    h_d2_dbeta2: FloatArray
    ddy: FloatArray
    p_fri: float
    decrease: Decrease | None = None
    relaxation: float = 0.0


class Motion(NamedTuple):
    """Accelerations of one instant and what they take.

    Attributes:
        ddq: (4,) [rad/s^2].
        forces: (7,) F_h, F_v [N], N_0 [N m], u_1 .. u_4 [N m].
    """

    ddq: FloatArray
    forces: FloatArray


class StanceDynamics:
    """Dynamics at one state with the stance foot at rest; every array is allocated once and overwritten.

    Args:
        biped: the robot.

    Attributes:
        M: (7, 7) mass matrix of the floating model, foot freedoms first.
        bias: (7,) its Coriolis and gravity terms.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        self._model = biped.floating
        self._data = biped.floating.createData()
        self._q, self._dq = np.zeros(BASE + 4), np.zeros(BASE + 4)
        self._line = np.zeros((2, BASE + 4))  # a and c, behind the foot at rest
        self._line[1, BASE] = 1.0
        self._k = np.zeros(4)
        self._of_outputs = np.zeros((4, 4))
        self._of_outputs[1:, :3] = np.eye(3)
        self.M, self.bias = np.eye(BASE + 4), np.zeros(BASE + 4)

    def move_to(self, q: FloatArray, dq: FloatArray) -> None:
        """Evaluate at q (4,) [rad], dq (4,) [rad/s]."""
        self._q[BASE:], self._dq[BASE:] = q, dq
        self.M = pin.crba(self._model, self._data, self._q)
        self.bias = pin.nonLinearEffects(self._model, self._data, self._q, self._dq)

    def linearising(self, targets: Targets) -> Motion | None:
        """The motion that meets all targets; None where I_P vanishes."""
        line, p_fri = self._line, targets.p_fri
        np.add(targets.ddy, targets.h_d2_dbeta2, out=line[0, BASE + 1 :])
        line[1, BASE + 1 :] = targets.h_d1
        forces, along = line.dot(self.M)  # M is symmetric
        forces += self.bias
        divisor = along.item(2) - p_fri * along.item(1)
        if divisor == 0.0:
            return None
        ddbeta = (p_fri * forces.item(1) - forces.item(2)) / divisor
        along *= ddbeta
        forces += along
        ddq = line[1, BASE:] * ddbeta
        ddq += line[0, BASE:]
        return Motion(ddq, forces)

    def along_residuals(self, p_fri: float, a_0: float, T_0: float) -> tuple[FloatArray, FloatArray]:
        """(4, 4) and (7, 4) derivatives of ddq and the forces with respect to the residuals of the last motion.

        Args:
            p_fri: its FRI target [m].
            a_0: unit of the outputs' residuals [rad/s^2].
            T_0: unit of the FRI's [N m].
        """
        M, c, k = self.M[:, BASE:], self._line[1, BASE:], self._k
        m = M[1] * -p_fri
        m += M[2]
        np.multiply(m[1:], -a_0, out=k[:3])
        k[3] = T_0
        k /= m.dot(c)
        ddq = c[:, None] * k
        ddq += a_0 * self._of_outputs
        return ddq, M.dot(ddq)
