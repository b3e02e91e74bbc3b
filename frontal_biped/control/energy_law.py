r"""Energy law: the ankle keeps the robot on the energy of its orbit, at every tick.

On the virtual constraints the robot has one degree of freedom, and E(beta) = dbeta^2/2 along the orbit is known for both
phases. The law asks for an additional acceleration

.. math:: \Delta = \mp \frac{\tfrac12 \dot\beta^2 - E(\beta)}{\ell} - a_\beta

(minus while rising, plus while falling), under which the energy error dies out over a length l of beta, whatever its
cause: an impact that took more than planned, a push, a model that is wrong. a_beta is the acceleration that the
estimator sees beyond what the model explains, averaged over a time much longer than its noise; each stance foot has its
own, remembered until that foot stands again, since a centre of mass that is off to one side errs in opposite senses on
the two feet.

The outputs keep their acceleration: D (1, h_d') Delta is added to the torques. Its first entry moves the FRI, and Delta
is cut to what the sole has room for.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.virtual_constraints.phase import StepPhase

TABLE = 129
"""Points at which the energy of an orbit is tabulated, and interpolated linearly between."""


@dataclass(frozen=True)
class EnergySettings:
    """How the energy of the orbit is kept.

    Attributes:
        length: over which an energy error dies out, as a share of the range of the phase [-]; inf: no feedback.
        average: time over which the acceleration error is averaged [s]; inf: it is not taken off.
        blank: time after a landing before it is, while the estimator recovers from the impact [s].
    """

    length: float = 0.4
    average: float = 0.15
    blank: float = 0.04


class EnergyLaw:
    """Torques that keep the energy of a gait's orbit.

    Args:
        biped: the robot as it is believed to be.
        gait: whose orbit.
        period: time between calls [s].
        settings: how fast.
    """

    def __init__(self, biped: FrontalBiped, gait: Gait, period: float, settings: EnergySettings) -> None:
        self.settings, self.period = settings, period
        self._model, self._data = biped.pinned, biped.pinned.createData()
        step = gait.step(biped)
        self._beta, self._energy, self._length = {}, {}, {}
        for phase, orbit in ((StepPhase.RISING, step.rising), (StepPhase.FALLING, step.falling)):
            order = np.argsort(orbit.beta)
            beta = np.linspace(orbit.beta.min(), orbit.beta.max(), TABLE)
            energy = np.interp(beta, orbit.beta[order], 0.5 * orbit.dbeta[order] ** 2)
            # past the ends it goes on straight: below zero past the reversal
            reach = float(np.ptp(beta))
            before, after = (energy[1] - energy[0]) / (beta[1] - beta[0]), float(orbit.ddbeta[np.argmax(orbit.beta)])
            self._beta[phase] = np.concatenate([[beta[0] - reach], beta, [beta[-1] + reach]])
            self._energy[phase] = np.concatenate([[energy[0] - reach * before], energy, [energy[-1] + reach * after]])
            self._length[phase] = settings.length * reach * (1.0 if phase is StepPhase.RISING else -1.0)
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start on a foot, the model trusted."""
        self.bias = {side: 0.0 for side in Stance}
        self.land(stance)

    def land(self, stance: Stance) -> None:
        """A foot has landed and is the stance foot."""
        self._stance, self._since = stance, 0.0

    def error(self, phase: StepPhase, beta: float, dbeta: float) -> float:
        """dbeta^2/2 beyond that of the orbit [rad^2/s^2]."""
        return 0.5 * dbeta**2 - float(np.interp(beta, self._beta[phase], self._energy[phase]))

    def torques(
        self,
        phase: StepPhase,
        q: FloatArray,
        dbeta: float,
        slope: FloatArray,
        unexplained: FloatArray,
        low: float,
        high: float,
    ) -> FloatArray:
        """What to add to the torques of the program.

        Args:
            phase: rising or falling.
            q: (4,) [rad].
            dbeta: [rad/s].
            slope: (3,) dh_d/dbeta at q [-].
            unexplained: (4,) acceleration that the model does not explain [rad/s^2].
            low: room of the stance ankle torque downwards, negative [N m].
            high: its room upwards [N m].

        Returns:
            (4,) [N m].
        """
        D = pin.crba(self._model, self._data, q)
        moved = D @ np.concatenate([[1.0], slope])  # torques for a unit of ddbeta
        self._since += self.period
        if self._since > self.settings.blank:
            share = self.period / self.settings.average
            self.bias[self._stance] += share * (float(D[0] @ unexplained) / float(moved[0]) - self.bias[self._stance])
        wanted = -self.error(phase, float(q[0]), dbeta) / self._length[phase] - self.bias[self._stance]
        ends = sorted((low / float(moved[0]), high / float(moved[0])))
        return moved * float(np.clip(wanted, min(ends[0], 0.0), max(ends[1], 0.0)))
