r"""Will a robot that is pushed outwards tip over its stance foot? The closed form's answer, from where it is.

Once its outputs are back, a pushed robot is on Z: from beta with zeta = (I_P dbeta)^2 / 2 it goes on with what a robot
would go on with that began the phase with

.. math:: \zeta^+ = e^{-\Gamma(\beta)} \zeta + R(\beta),

the energy of `zero_dynamics.energy` solved for its start, and it comes over the barrier where that is more than the
highest R. Of a robot whose outputs are not back yet this is an estimate.
"""

import numpy as np

from frontal_biped.exceptions import ReversalError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.state import State
from frontal_biped.virtual_constraints.contract import RisingConstraints
from frontal_biped.zero_dynamics.half_steps import rising_energy
from frontal_biped.zero_dynamics.restricted import restrict


def comes_over_the_barrier(biped: FrontalBiped, phase: RisingConstraints, state: State) -> bool:
    """Does a rising robot tip over its stance foot?

    Args:
        biped: the robot, on its stance foot.
        phase: the rising phase that it is in.
        state: where it is in it, in stance coordinates.
    """
    beta = state.q.item(0)
    try:
        energy = rising_energy(biped, phase)
        if beta >= energy.end:
            return True
        growth, spent = energy.at(beta)
    except ReversalError:  # before the phase, or not on it
        return False
    zeta = 0.5 * (restrict(biped, phase, np.array([beta])).I_P.item(0) * state.dbeta) ** 2
    return float(np.exp(-growth) * zeta + spent) > energy.highest
