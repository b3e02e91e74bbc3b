r"""What the walking robot makes of its readings: stance coordinates, their rates, and how wrong its model is.

Between readings the model predicts, under the torques that were applied, with one acceleration error for each joint:

.. math:: \ddot q = D^{-1}(u - C \dot q - G) + a, \qquad \dot a = \text{noise}

A reading corrects q, dq and a by the gains of a Kalman filter. The error of each joint is taken for a triple integrator
of its own, so the gains depend on nothing but the time since the last impact, and are tabulated once: after an impact
the velocities are uncertain, since the impact map of a wrong model is wrong, and a few readings put them right.

The stance foot is known to stand, but not that it stands flat: the absolute angle of the stance leg, which is what
gravity sees, comes from the pelvis' roll and the hip; the ankle's encoder would add the tilt of the foot.

The acceleration error of one stance foot is remembered until that foot stands again: a pelvis whose centre of mass is
off to one side errs in opposite senses on the two feet.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.control.walker.estimator_gains import TABULATED, EstimatorSettings, joint_gains
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.chain import UPRIGHT
from frontal_biped.model.impact import impact
from frontal_biped.model.stance_map import Stance

LARGEST = 1e6
"""Of what is estimated, in rad, rad/s and rad/s^2: no robot comes near, and squares of it are still numbers."""


class StateEstimator:
    """Estimates state and model error in stance coordinates.

    Args:
        biped: the robot as it is believed to be.
        period: time between readings [s].
        settings: what to trust.
        delay: from a reading to the torques it leads to [s].
    """

    def __init__(
        self, biped: FrontalBiped, period: float, settings: EstimatorSettings | None = None, delay: float = 0.0
    ) -> None:
        self.biped, self.period = biped, period
        self.settings = settings or EstimatorSettings()
        self._model, self._data = biped.pinned, biped.pinned.createData()
        chosen = self.settings
        # until the landing is noticed, the old ankle torque turns the foot that has become the swing foot
        torque = 0.3 * biped.weight * biped.sole[1]
        turned = torque * (period + delay) / float(biped.D(np.full(4, UPRIGHT))[3, 3])
        foot = replace(chosen, impact_velocity=max(chosen.impact_velocity, turned), blind=0.0)
        joints = (chosen, chosen, chosen, foot)
        # after every number of readings, of positions alone, and of positions and velocities
        self._by_positions, self._by_both = (list(joint_gains(joints, period, rates)) for rates in (False, True))
        self._off = np.zeros((2, 4))  # readings from the estimate: positions and velocities
        self._off_position, self._off_velocity, self._off_both = *self._off, self._off.reshape(8)
        half = 0.5 * period
        # of the rows q, dq, the error, and the model's accelerations at the beginning and in the middle
        self._middle = np.array([[1.0, half, 0.0, 0.0], [0.0, 1.0, half, half]])
        self._end = np.array(
            [
                [1.0, period, period * half, period * half, 0.0],
                [0.0, 1.0, period, 0.0, period],
                [0.0, 0.0, 1.0, 0.0, 0.0],
            ]
        )
        self._known, self._stage = np.zeros((5, 4)), np.zeros((2, 4))
        self._first = self._known[:4]  # what is known before the middle; views, as the next are, made once
        self._now, self._midway = tuple(self._known[:2]), tuple(self._stage)
        self.reset(Stance.LEFT, np.zeros(4), np.zeros(4))
        self._readings = 0

    @property
    def q(self) -> FloatArray:
        """(4,) estimate [rad]."""
        return self._estimate[0]

    @property
    def dq(self) -> FloatArray:
        """(4,) its rate [rad/s]."""
        return self._estimate[1]

    @property
    def error(self) -> FloatArray:
        """(4,) acceleration error of the model [rad/s^2]."""
        return self._estimate[2]

    def reset(self, stance: Stance, q: FloatArray, dq: FloatArray) -> None:
        """Start at a known state, the model trusted."""
        self._estimate = np.array((q, dq, np.zeros(4)))
        self._remembered = {stance: np.zeros(4) for stance in Stance}
        self._stance, self._readings = stance, TABULATED - 1

    def predict(self, u: FloatArray, ddq: FloatArray | None = None) -> None:
        """One period on, before a reading.

        Args:
            u: (4,) torques that were applied in it [N m].
            ddq: (4,) the model's acceleration under them at the estimate, where it is known [rad/s^2].
        """
        self._estimate = self._advanced(self._estimate, u, ddq)

    def correct(self, q: FloatArray, dq: FloatArray | None = None) -> None:
        """Take a reading of q (4,) [rad], and of dq (4,) [rad/s] if there is one."""
        at = min(self._readings, TABULATED - 1)
        self._readings += 1
        estimate = self._estimate
        np.subtract(q, estimate[0], self._off_position)
        if dq is None:
            gains, off = self._by_positions[at], self._off_position
        else:
            gains, off = self._by_both[at], self._off_both
            np.subtract(dq, estimate[1], self._off_velocity)
        corrected = gains.dot(off)
        corrected += estimate.reshape(12)
        if not _are_sensible(corrected):
            # what is infinite is so of one joint, which the zeros of a matrix do not see to
            corrected = _sensible(gains.dot(_sensible(off)) + estimate.reshape(12))
        self._estimate = corrected.reshape(3, 4)

    def land(self) -> None:
        """The swing foot lands and becomes the stance foot; if it lands tilted, the leg keeps its absolute angle."""
        landed = impact(self.biped, self.q, self.dq)
        tilt = float(self.biped.swing_foot_rotation(self.q))
        self._remembered[self._stance] = self.error
        self._stance = self._stance.other
        self._estimate = np.array((landed.q_plus, landed.dq_plus, self._remembered[self._stance]))
        self._estimate[0, 0] -= tilt
        self._readings = 0

    def ahead(self, torques: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray]:
        """q and dq after torques (4,) [N m] that are on their way, each held for a period."""
        estimate = self._estimate
        for u in torques:
            estimate = _sensible(self._advanced(estimate, u))
        return estimate[0], estimate[1]

    def _advanced(self, estimate: FloatArray, u: FloatArray, ddq: FloatArray | None = None) -> FloatArray:
        """(3, 4) an estimate one period on, by a midpoint step with the error held."""
        aba, model, data, known = pin.aba, self._model, self._data, self._known
        known[:3] = estimate
        known[3] = aba(model, data, *self._now, u) if ddq is None else ddq
        self._middle.dot(self._first, self._stage)
        known[4] = aba(model, data, *self._midway, u)
        after: FloatArray = self._end.dot(known)
        return after


def _sensible(values: FloatArray) -> FloatArray:
    """Values that can be reckoned with, whatever a broken sensor says: none beyond `LARGEST`."""
    return values if _are_sensible(values) else np.minimum(np.maximum(values, -LARGEST), LARGEST)


def _are_sensible(values: FloatArray) -> bool:
    """Is even their sum of squares small? It is told in half the time, and true of all that robots do."""
    return bool(np.vdot(values, values) <= LARGEST**2)
