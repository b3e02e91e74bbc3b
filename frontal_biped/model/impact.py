"""Rigid impact of the swing foot: [O] eq. impactModel, from Pinocchio's contact dynamics on the floating model.

    [ M  -J' ] [ v+ ]   [ M v- ]
    [ J   0  ] [ L  ] = [  0   ]

v- holds the stance foot at rest; the landing foot sticks (two translations and the rotation); the old stance foot
is free to leave. The roles of the legs are then exchanged.
"""

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.model.biped import BASE, FrontalBiped
from frontal_biped.model.stance_map import relabel
from frontal_biped.model.state import State

_PLANAR_ROWS = [0, 1, 5]  # h, v and the rotation out of the plane


class Landing(NamedTuple):
    """What an impact does; every rate in it is linear in the velocities before it.

    Of the actual velocities it is in SI units as given; of a slope dq/dbeta, as on the zero dynamics, it is per unit of
    dbeta: lengths for velocities, kg m for N s.

    Attributes:
        q_plus: (4,) configuration after relabelling [rad].
        dq_plus: (4,) velocities after the impact, relabelled [rad/s].
        impulse: (3,) L_h, L_v [N s] on the landing foot and its moment about the sole point below the ankle
            [N m s], in the (h, v) frame of the *old* stance foot.
        lift_off: (2,) vertical velocity of the old stance sole's inner and outer end after the impact [m/s].
        touchdown: (2,) vertical velocity of the landing sole's inner and outer end before it [m/s].
    """

    q_plus: FloatArray
    dq_plus: FloatArray
    impulse: FloatArray
    lift_off: FloatArray
    touchdown: FloatArray

    @property
    def state(self) -> State:
        """The state after it."""
        return State(self.q_plus, self.dq_plus)

    @property
    def speed_ratio(self) -> float:
        """Of a slope: dbeta_r+ / dbeta_f- [-], negative."""
        return self.dq_plus[0]

    @property
    def slope(self) -> FloatArray:
        """(3,) dq_b/dbeta after it [-]."""
        return self.dq_plus[1:] / self.dq_plus[0]

    @property
    def center_of_pressure(self) -> float:
        """Where the impulse acts on the landing sole, from its ankle, positive in the old h direction [m]."""
        return float(self.impulse[2] / self.impulse[1])

    @property
    def friction_used(self) -> float:
        """Coefficient of friction that keeps the landing foot from slipping, |L_h| / L_v; inf if the ground pulls."""
        return float(abs(self.impulse[0]) / self.impulse[1]) if self.impulse[1] > 0.0 else float("inf")


def impact(biped: FrontalBiped, q_minus: FloatArray, dq_minus: FloatArray) -> Landing:
    """Land the swing foot.

    Args:
        biped: the robot.
        q_minus: (4,) configuration at impact, swing foot on the ground [rad].
        dq_minus: (4,) velocities just before [rad/s], or the slope dq/dbeta there [-].

    Returns:
        The relabelled state, the impulse, and the rates of both soles.
    """
    model, data = biped.floating, biped._floating_data
    q, v_minus = np.zeros(BASE + 4), np.zeros(BASE + 4)
    q[BASE:], v_minus[BASE:] = q_minus, dq_minus
    J = landing_jacobian(biped, q)
    v_plus = np.array(pin.impulseDynamics(model, data, q, v_minus, J, 0.0, 0.0))
    impulse = np.array(data.impulse_c)
    # moment about the ankle -> about the sole point h_a below it: (0, h_a) x L = -h_a L_h from the sole's lever
    impulse[2] -= biped.ankle_height * impulse[0]
    outer, inner = biped.sole
    return Landing(
        q_plus=relabel(q_minus),
        dq_plus=relabel(v_plus[BASE:]),
        impulse=impulse,
        lift_off=np.array([v_plus[1] + v_plus[2] * inner, v_plus[1] + v_plus[2] * outer]),
        touchdown=biped.swing_sole_jacobian(q_minus)[:, 1] @ dq_minus,
    )


def landing_jacobian(biped: FrontalBiped, q_floating: FloatArray) -> FloatArray:
    """(3, 7) Jacobian of the swing ankle: h, v, rotation, for the floating configuration (7,)."""
    model, data = biped.floating, biped._floating_data
    pin.computeJointJacobians(model, data, q_floating)
    jacobian = pin.getJointJacobian(model, data, model.njoints - 1, pin.LOCAL_WORLD_ALIGNED)
    return np.ascontiguousarray(jacobian[_PLANAR_ROWS])
