"""The input-output linearising torque in closed form, with the FRI on its target.

The accelerations that give the output the acceleration asked for are a line, ddq = a + c ddbeta with a = (0, v + h_d''
dbeta^2) and c = (1, h_d'). The generalised forces along it are W = M a + bias + M c ddbeta, with M and bias of the
floating model held still, W = (F_h, F_v, N_0, u); its rows F_v and N_0 give the one unknown left from N_0 = p_FRI F_v.
The divisor, (M c)_N - p_FRI (M c)_F, is I_P on Z, and zero exactly where the decoupling matrix is singular (C03).

A motion that misses its targets by ddy - v = a_0 r_1..3, N_0 - p_FRI F_v = T_0 r_4 is affine in the residuals r, with
m = M_N - p_FRI M_F and I_P = m c:

    dddbeta/dr = k = (-a_0 m_b, T_0) / I_P,    dddq/dr = c k' + a_0 [0 0; I 0],    dW/dr = M dddq/dr

Where the outputs are functions of the sway s instead (`model.sway`), dds = J ddq + drift takes the place of ddbeta. The
line is then one over dds: its body part is as before, and the ankle follows from J, whose first entry is the height of
the centre of mass and never zero:

    a = (-(drift + J_b a_b) / J_1, a_b),    c = ((1 - J_b h_d') / J_1, h_d')

and an output's residual moves the ankle by -J_b / J_1 with it.
"""

from math import inf
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.control.torques.lyapunov import Decrease
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.model.sway import Sway
from frontal_biped.model.urdf.description import ROLL_JOINTS

JOINTS = len(ROLL_JOINTS)
"""Freedoms of the pinned robot, and so of its accelerations, torques and residuals."""

BODY_JOINTS = JOINTS - 1
"""Joints above the stance ankle, one output each."""

FRI = BODY_JOINTS
"""Place in the residuals: first those of the outputs, then that of the FRI."""

STEEP = 1e8
"""Norm of the accelerations by the residuals [rad/s^2], above which I_P nearly vanishes: the linearising motion is as
large, and what is left of it when limits are kept has lost as many digits."""

F_H, F_V, N_0 = range(BASE)
"""Places in the generalised forces: the ground's on the stance foot, in the order of its freedoms, then the torques."""


class Targets(NamedTuple):
    """What the controller asks of one instant.

    Attributes:
        h_d1: (3,) dh_d/dbeta [-]; over the sway dh_d/ds [rad/m].
        h_d2_dbeta2: (3,) h_d'' dbeta^2, over the sway h_d'' ds^2 [rad/s^2].
        ddy: (3,) wanted output acceleration v [rad/s^2].
        p_fri: wanted FRI [m].
        decrease: with a control Lyapunov function, the condition whose least v is ``ddy``; None without.
        relaxation: delta of that v [rad/s^2].
        sway: what the outputs are functions of; None: of beta.
    """

    h_d1: FloatArray
    h_d2_dbeta2: FloatArray
    ddy: FloatArray
    p_fri: float
    decrease: Decrease | None = None
    relaxation: float = 0.0
    sway: Sway | None = None

    def line(self) -> FloatArray:
        """(2, 4) accelerations a + c x that give the outputs theirs: a [rad/s^2], and c, by the phase's variable x."""
        a, c = self.ddy + self.h_d2_dbeta2, self.h_d1
        line = np.array((0.0, *a.tolist(), 1.0, *c.tolist())).reshape(2, JOINTS)
        return line if self.sway is None else over_sway(line, self.sway)

    def slope(self) -> FloatArray:
        """(4,) c of the line alone."""
        c_2, c_3, c_4 = self.h_d1.tolist()
        if self.sway is None:
            return np.array((1.0, c_2, c_3, c_4))
        J_1, J_2, J_3, J_4 = self.sway.J.tolist()
        return np.array(((1.0 - (J_2 * c_2 + J_3 * c_3 + J_4 * c_4)) / J_1, c_2, c_3, c_4))

    def of_outputs(self) -> FloatArray:
        """(4, 4) accelerations that the outputs' residuals take at an unchanged rate of the phase's variable."""
        if self.sway is None:
            return _OF_OUTPUTS
        of_outputs = _OF_OUTPUTS.copy()
        of_outputs[0, :FRI] = self.sway.J[1:] / -self.sway.J.item(0)
        return of_outputs


def over_sway(line: FloatArray, sway: Sway) -> FloatArray:
    """The line of outputs over the sway, of that over beta (2, 4), which is written over: the ankle follows from J."""
    J_1, J_2, J_3, J_4 = sway.J.tolist()  # plain numbers: three of them are faster than a call of NumPy
    (_, a_2, a_3, a_4), (_, c_2, c_3, c_4) = line.tolist()
    line[0, 0] = -(sway.drift + (J_2 * a_2 + J_3 * a_3 + J_4 * a_4)) / J_1
    line[1, 0] = (1.0 - (J_2 * c_2 + J_3 * c_3 + J_4 * c_4)) / J_1
    return line


class Motion(NamedTuple):
    """Accelerations of one instant and what they take.

    Attributes:
        ddq: (4,) [rad/s^2].
        forces: (7,) F_h, F_v [N], N_0 [N m], u_1 .. u_4 [N m].
    """

    ddq: FloatArray
    forces: FloatArray


class StanceDynamics(NamedTuple):
    """Dynamics at one state with the stance foot at rest: a value, evaluated once a tick (`StanceModel.at`).

    Attributes:
        state: where they were evaluated.
        M: (7, 7) mass matrix of the floating model, foot freedoms first.
        bias: (7,) its Coriolis and gravity terms.
    """

    state: State
    M: FloatArray
    bias: FloatArray

    def linearising(self, targets: Targets) -> Motion | None:
        """The motion that meets all targets; None where I_P vanishes."""
        return self.on_line(targets.line(), targets.p_fri)

    def on_line(self, line: FloatArray, p_fri: float) -> Motion | None:
        """The motion on a line of accelerations (2, 4) that has the FRI at ``p_fri`` [m]; None where I_P vanishes."""
        of_line = line.dot(self.M[BASE:])  # M is symmetric, and the foot at rest
        forces, along = of_line[0], of_line[1]
        forces += self.bias
        divisor = along.item(N_0) - p_fri * along.item(F_V)
        if divisor == 0.0:
            return None
        point = np.array((1.0, (p_fri * forces.item(F_V) - forces.item(N_0)) / divisor))
        return Motion(point.dot(line), point.dot(of_line))

    def by_residuals(self, targets: Targets, a_0: float, T_0: float) -> FloatArray | None:
        """(4, 5) matrix that takes (r, 1) to the accelerations of a motion with residuals r; None where it is `STEEP`.

        Its last column is `linearising`, to rounding.

        Args:
            targets: that the residuals are of.
            a_0: unit of the outputs' residuals [rad/s^2].
            T_0: unit of the FRI's [N m].
        """
        # in plain numbers, as `tracking`
        (f_1, f_2, f_3, f_4), (n_1, n_2, n_3, n_4) = self.M[F_V : N_0 + 1, BASE:].tolist()
        p = targets.p_fri
        m_1, m_2, m_3, m_4 = n_1 - p * f_1, n_2 - p * f_2, n_3 - p * f_3, n_4 - p * f_4
        c_2, c_3, c_4 = targets.h_d1.tolist()
        (v_2, v_3, v_4), (b_2, b_3, b_4) = targets.ddy.tolist(), targets.h_d2_dbeta2.tolist()
        a_2, a_3, a_4 = v_2 + b_2, v_3 + b_3, v_4 + b_4
        c_1, a_1, s_1, s_2, s_3 = 1.0, 0.0, 0.0, 0.0, 0.0  # s: by how much an output's residual moves the ankle
        if targets.sway is not None:
            c_1 = targets.slope().item(0)
            s_1, s_2, s_3 = targets.of_outputs()[0, :FRI].tolist()
            a_1 = s_1 * a_2 + s_2 * a_3 + s_3 * a_4 - targets.sway.drift / targets.sway.J.item(0)
        I_P = m_1 * c_1 + m_2 * c_2 + m_3 * c_3 + m_4 * c_4
        unit = -a_0 / I_P if I_P else inf
        k_1, k_2, k_3 = unit * (m_2 + m_1 * s_1), unit * (m_3 + m_1 * s_2), unit * (m_4 + m_1 * s_3)
        k_4 = unit * (T_0 / -a_0)
        slope, pull = c_1 * c_1 + c_2 * c_2 + c_3 * c_3 + c_4 * c_4, k_1 * k_1 + k_2 * k_2 + k_3 * k_3 + k_4 * k_4
        if not slope * pull < STEEP * STEEP:
            return None
        bias = self.bias.item(N_0) - p * self.bias.item(F_V)
        x = (m_1 * a_1 + m_2 * a_2 + m_3 * a_3 + m_4 * a_4 + bias) / -I_P
        # fmt: off
        numbers = (
            c_1 * k_1 + a_0 * s_1, c_1 * k_2 + a_0 * s_2, c_1 * k_3 + a_0 * s_3, c_1 * k_4, a_1 + x * c_1,
            c_2 * k_1 + a_0, c_2 * k_2, c_2 * k_3, c_2 * k_4, a_2 + x * c_2,
            c_3 * k_1, c_3 * k_2 + a_0, c_3 * k_3, c_3 * k_4, a_3 + x * c_3,
            c_4 * k_1, c_4 * k_2, c_4 * k_3 + a_0, c_4 * k_4, a_4 + x * c_4,
        )
        # fmt: on
        return np.fromiter(numbers, float, len(numbers)).reshape(JOINTS, JOINTS + 1)  # twice as fast as `np.array`

    def sway(self, mass: float) -> Sway:
        """The sway, from what is known of the momentum of a robot of that mass [kg].

        Turned about the ground point below the stance ankle, the robot moves m p_cm^h upwards per unit of its rate; and
        F_H = m dds, for the foot is at rest.
        """
        J = self.M[F_H, BASE:] / mass
        J_1, J_2, J_3, J_4 = J.tolist()
        dq_1, dq_2, dq_3, dq_4 = self.state.dq.tolist()
        rate = J_1 * dq_1 + J_2 * dq_2 + J_3 * dq_3 + J_4 * dq_4
        return Sway(self.M.item(N_0, F_V) / mass, rate, J, self.bias.item(F_H) / mass)


_OF_OUTPUTS = np.eye(JOINTS, k=-1)
"""(4, 4) residuals to body joints: the first output is of the second joint."""


class StanceModel:
    """Evaluates the dynamics of a robot whose stance foot is at rest.

    Owns Pinocchio's work data; what is handed out is not part of it (Pinocchio returns copies), so that a value kept
    from one tick stays what it was at the next.

    Args:
        biped: the robot.
    """

    def __init__(self, biped: FrontalBiped) -> None:
        # the foot on one planar joint: a fifth less time than on three joints of one freedom each, for the same numbers
        self._model = biped.planar_base
        self._data = self._model.createData()
        self._q, self._dq = pin.neutral(self._model), np.zeros(BASE + JOINTS)
        self._joints, self._rates = self._q[-JOINTS:], self._dq[BASE:]

    def at(self, state: State) -> StanceDynamics:
        """The dynamics at a state."""
        model, data, q = self._model, self._data, self._q
        self._joints[:], self._rates[:] = state
        M = pin.crba(model, data, q)
        return StanceDynamics(state, M, pin.nonLinearEffects(model, data, q, self._dq))
