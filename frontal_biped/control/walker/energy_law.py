r"""Energy law: the ankle keeps the robot on the energy of its orbit, at every tick.

On the virtual constraints the robot has one degree of freedom, and E(beta) = dbeta^2/2 along the orbit is known for
both phases. The law asks for an additional acceleration

.. math:: \Delta = \mp \frac{\tfrac12 \dot\beta^2 - E(\beta)}{\ell} - a_\beta

(minus while rising, plus while falling), under which the energy error dies out over a length l of beta, whatever its
cause: an impact that took more than planned, a push, a model that is wrong. a_beta is the acceleration that the
estimator sees beyond what the model explains, averaged over a time much longer than its noise; each stance foot has its
own, remembered until that foot stands again, since a centre of mass that is off to one side errs in opposite senses on
the two feet.

It is the ankle that gives it: the FRI target moves by I_P Delta / (m g), inside the sole; the outputs are not
disturbed.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.stance_map import Stance
from frontal_biped.numerics.between import between
from frontal_biped.virtual_constraints.phase import StepPhase

TABLE = 129
"""Points at which the energy of an orbit is tabulated, and interpolated linearly between."""


@dataclass(frozen=True)
class EnergySettings:
    """How the energy of the orbit is kept.

    Attributes:
        length: over which an energy error dies out, as a share of the range of the phase [-]; inf: no feedback.
        average: time over which the acceleration error is averaged [s]; inf: it is not taken off.
        blank: time after a landing without feedback and averaging [s]; in the same time again the feedback grows.
    """

    length: float = 0.6
    average: float = 0.15
    blank: float = 0.03


class EnergyLaw:
    """Shifts of the FRI target that keep the energy of a gait's orbit.

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
        self._weight = biped.weight
        self._beta: dict[StepPhase, FloatArray] = {}
        self._energy: dict[StepPhase, FloatArray] = {}
        self._inertia: dict[StepPhase, FloatArray] = {}
        self._length: dict[StepPhase, float] = {}
        for phase, orbit in ((StepPhase.RISING, step.rising), (StepPhase.FALLING, step.falling)):
            order = np.argsort(orbit.beta)
            beta = np.linspace(orbit.beta.min(), orbit.beta.max(), TABLE)
            energy = np.interp(beta, orbit.beta[order], 0.5 * orbit.dbeta[order] ** 2)
            inertia = np.interp(beta, orbit.beta[order], orbit.restricted.I_P[order])
            self._inertia[phase] = np.concatenate([inertia[:1], inertia, inertia[-1:]])
            # past the ends it goes on straight: below zero past the reversal
            reach = float(np.ptp(beta))
            before, after = (energy[1] - energy[0]) / (beta[1] - beta[0]), float(orbit.ddbeta[np.argmax(orbit.beta)])
            self._beta[phase] = np.concatenate([[beta[0] - reach], beta, [beta[-1] + reach]])
            self._energy[phase] = np.concatenate([[energy[0] - reach * before], energy, [energy[-1] + reach * after]])
            self._length[phase] = settings.length * reach * phase.sign
        self.reset(Stance.LEFT)

    def reset(self, stance: Stance) -> None:
        """Start on a foot, the model trusted."""
        self.bias = dict.fromkeys(Stance, 0.0)
        self.land(stance)

    def land(self, stance: Stance) -> None:
        """A foot has landed and is the stance foot."""
        self._stance, self._since = stance, 0.0

    def error(self, phase: StepPhase, beta: float, dbeta: float) -> float:
        """dbeta^2/2 beyond that of the orbit [rad^2/s^2]."""
        return 0.5 * dbeta**2 - float(np.interp(beta, self._beta[phase], self._energy[phase]))

    def fri_shift(self, phase: StepPhase, q: FloatArray, dbeta: float, unexplained: FloatArray) -> float:
        """How far to move the FRI target [m].

        Args:
            phase: rising or falling.
            q: (4,) [rad].
            dbeta: [rad/s].
            unexplained: (4,) acceleration that the model does not explain [rad/s^2].
        """
        beta = float(q[0])
        inertia = float(np.interp(beta, self._beta[phase], self._inertia[phase]))
        self._since += self.period
        if self._since > self.settings.blank:
            D = pin.crba(self._model, self._data, q)
            share = self.period / self.settings.average
            self.bias[self._stance] += share * (float(D[0] @ unexplained) / inertia - self.bias[self._stance])
        # the foot rocks after a landing, and the estimate with it
        trust = between(0.0, self._since / self.settings.blank - 1.0, 1.0)
        wanted = -trust * self.error(phase, beta, dbeta) / self._length[phase] - self.bias[self._stance]
        return inertia * wanted / self._weight
