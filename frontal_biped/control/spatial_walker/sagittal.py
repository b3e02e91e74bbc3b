r"""The law of the sagittal plane: where the centre of pressure is to be, and where the next foot.

With the divergent component :math:`\xi = x + \dot x/\omega` ahead of the stance ankle, omega^2 = g/z, a step of length
L and duration T under a centre of pressure at p_ref is

.. math:: \xi_{ref}(t) = p_{ref} + L \frac{e^{\omega t}}{e^{\omega T} - 1},

t since the landing. The centre of pressure brings an error of it to zero at a rate k,

.. math:: p_x = p_{ref} + (1 + k/\omega)(\xi - \xi_{ref}),

as far as the sole reaches; what is left at the landing is taken over by the foothold, which is placed where xi is to
begin the next step.
"""

from dataclasses import dataclass

import numpy as np

from frontal_biped.model.chain import GRAVITY
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance


@dataclass(frozen=True)
class SagittalSettings:
    """How the sagittal plane is kept.

    Attributes:
        rate: k, at which an error of xi dies out under the centre of pressure [1/s].
        cop_share: share of half the sole's length, from its middle, inside which the centre of pressure is asked for.
        undisturbed_share: the same of an undisturbed step; inside it is below the centre of mass of the posture.
        speed_change: by how much the mean speed may change from a step to the next [m/s].
    """

    rate: float = 3.0
    cop_share: float = 0.8
    undisturbed_share: float = 0.4
    speed_change: float = 0.15


@dataclass(frozen=True)
class SagittalLaw:
    """One robot's sagittal law; lengths from the stance ankle forwards.

    Attributes:
        omega: sqrt(g/z) [1/s].
        duration: of a step, T [s].
        p_ref: centre of pressure of an undisturbed step [m].
        reach: hindmost and foremost centre of pressure [m].
        settings: how the plane is kept.
    """

    omega: float
    duration: float
    p_ref: float
    reach: tuple[float, float]
    settings: SagittalSettings

    @classmethod
    def of(cls, state: SpaceState, duration: float, settings: SagittalSettings) -> "SagittalLaw":
        """The law of a robot.

        Args:
            state: the robot at its posture, at rest.
            duration: of a step [s].
            settings: how the plane is kept.
        """
        sole = state.free.soles.left
        middle, half = 0.5 * (sole.front - sole.back), 0.5 * sole.length
        ahead = float(state.com[0] - state.feet[Stance.LEFT].position[0])
        room = settings.undisturbed_share * half
        p_ref = min(max(ahead, middle - room), middle + room)
        reach = settings.cop_share * half
        omega = float(np.sqrt(GRAVITY / state.com[2]))
        return cls(omega, duration, p_ref, (middle - reach, middle + reach), settings)

    def reference(self, length: float, left: float) -> float:
        """xi_ref [m] of a step of a length [m] with a time left [s]."""
        growth = np.exp(self.omega * self.duration)
        return self.p_ref + length * growth / (growth - 1.0) * float(np.exp(-self.omega * left))

    def begin(self, length: float) -> float:
        """xi_ref [m] at the start of a step of a length [m]."""
        return self.reference(length, self.duration)

    def cop(self, xi: float, length: float, left: float) -> float:
        """Centre of pressure [m] asked for."""
        error = xi - self.reference(length, left)
        wanted = self.p_ref + (1.0 + self.settings.rate / self.omega) * error
        return float(min(max(wanted, self.reach[0]), self.reach[1]))

    def foothold(self, xi: float, length: float, next_length: float, left: float) -> float:
        """Where the next ankle is to be [m], so that the next step of ``next_length`` begins on its reference.

        Args:
            xi: divergent component [m].
            length: of the present step [m].
            next_length: of the next one [m].
            left: time to the landing [s].
        """
        error = xi - self.reference(length, left)
        gain = 1.0 + self.settings.rate / self.omega
        push = gain * error
        room = self.reach[1] - self.p_ref if error > 0.0 else self.reach[0] - self.p_ref
        if abs(push) <= abs(room):
            error *= float(np.exp(-self.settings.rate * left))
        else:  # the sole is at its end: what it cannot brake grows
            error = room + (error - room) * float(np.exp(self.omega * left))
        return self.reference(length, 0.0) + error - self.begin(next_length)
