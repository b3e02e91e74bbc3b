"""Where a reversal point can lie.

[O] Sec. III-E: in ]beta_r+, beta_r^max[, where beta_r^max brings the centre of mass over the FRI target with the joints
frozen in the pose of the reversal.
"""

import numpy as np
from scipy.optimize import brentq

from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.virtual_constraints.phase import Phase

ROOT_TOLERANCE = 1e-14  # [rad]


def beta_maximum(biped: FrontalBiped, rising: Phase) -> float:
    """beta_r^max: joints frozen in the reversal pose, the centre of mass above the FRI target [rad].

    Raises:
        ReversalError: the centre of mass never gets there before beta = 0.
    """
    end = rising.motion(np.array([rising.beta_end]))
    pose, p_fri = end.q[0], float(end.p_fri[0])

    def offset(beta: float) -> float:
        frozen = pose.copy()
        frozen[0] = beta
        return float(biped.com(frozen)[0]) - p_fri

    # turning the frozen robot about its ankle moves the centre of mass on a circle: down to beta = 0 it crosses once
    if offset(rising.beta_end) <= 0.0:
        raise ReversalError(
            f"the centre of mass is already outside the FRI target at the planned reversal {rising.beta_end:.6g} rad"
        )
    high = rising.beta_end
    while high < 0.0:
        high += 0.1
        if offset(high) < 0.0:
            return float(brentq(offset, high - 0.1, high, xtol=ROOT_TOLERANCE))
    raise ReversalError("the centre of mass stays inside the FRI target for every beta below 0")
