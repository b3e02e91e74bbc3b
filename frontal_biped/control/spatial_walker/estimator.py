r"""What the walking robot in space makes of its readings: configuration, velocity, and what its model does not explain.

Encoders and the inertial unit tell every joint and the pelvis' orientation; where the robot is and how fast, nobody
does. The stance foot is taken to be at rest where it stands: then the base follows from the joints,

.. math:: v_{base} = -v_{sole}(q, \dot q, \omega), \qquad p_{base} = p_{foothold} - p_{sole}(q).

Between readings the program's own accelerations predict, with one unexplained acceleration for each joint and each
axis of the pelvis, and a reading corrects by the gains of `estimator_gains`. At a landing the velocities jump as the
impulse of a flat sole, every joint free, makes them.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
import pinocchio as pin
from scipy.linalg import cho_factor, cho_solve

from frontal_biped.arrays import FloatArray
from frontal_biped.control.spatial_walker.interface import SpatialReading
from frontal_biped.control.walker.estimator_gains import TABULATED, EstimatorSettings, gain_table
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.stance_map import Stance

TURNING = slice(3, BASE)
"""Of a velocity: the base's angular part."""

JOINTS = slice(BASE, None)


@dataclass(frozen=True)
class SpatialEstimatorSettings:
    """How much the estimator trusts what.

    Attributes:
        joints: of the encoders.
        pelvis: of the inertial unit; its ``encoder_noise`` is that of the orientation [rad], its ``velocity_noise``
            that of the rates [rad/s].
    """

    joints: EstimatorSettings = field(default_factory=EstimatorSettings)
    pelvis: EstimatorSettings = field(
        default_factory=lambda: EstimatorSettings(encoder_noise=2e-3, velocity_noise=5e-3)
    )


class SpatialEstimator:
    """Estimates the state of a free robot.

    Args:
        free: the robot as it is believed to be.
        period: time between readings [s].
        settings: what to trust.

    Attributes:
        q: (nq,) estimate, the base where the foothold puts it.
        v: (nv,) estimate.
        error: (nv,) acceleration that the model does not explain; zero for the base's linear part.
        foothold: (3,) where the stance sole is believed to be in the world [m].
    """

    def __init__(self, free: FreeRobot, period: float, settings: SpatialEstimatorSettings | None = None) -> None:
        self.free, self.period = free, period
        chosen = settings or SpatialEstimatorSettings()
        self._model, self._data = free.model, free.model.createData()
        self._pelvis = gain_table(chosen.pelvis, period, velocities=True)
        self._joints = {known: gain_table(chosen.joints, period, velocities=known) for known in (False, True)}
        self._corners = dict(zip(Stance, (sole.corners for sole in free.soles), strict=True))
        self.reset(Stance.LEFT, free.posture, np.zeros(free.model.nv))

    def reset(self, stance: Stance, q: FloatArray, v: FloatArray) -> None:
        """Start at a known state, the model trusted."""
        self.q, self.v, self.error = q.copy(), v.copy(), np.zeros_like(v)
        self._remembered = {side: np.zeros_like(v) for side in Stance}
        self._stance, self._readings = stance, TABULATED - 1
        self.foothold = np.zeros(3)
        self.foothold = self.sole(stance)

    def predict(self, dv: FloatArray) -> None:
        """One period on, under the accelerations (nv,) that the program expected."""
        self.q, self.v = self._advanced(self.q, self.v, dv)

    def correct(self, reading: SpatialReading) -> None:
        """Take a reading, and put the base where the stance foot has it."""
        at = min(self._readings, TABULATED - 1)
        self._readings += 1
        R = pin.Quaternion(self.q[6], self.q[3], self.q[4], self.q[5]).matrix()
        turned = pin.log3(R.T @ reading.base_rotation)
        gains = self._pelvis[at]
        self._take(
            TURNING, gains[:, 0, None] * turned + gains[:, 1, None] * (reading.base_angular_velocity - self.v[TURNING])
        )
        self.q[3:7] = pin.Quaternion(R @ pin.exp3(gains[0, 0] * turned)).coeffs()
        missed = reading.joint_positions - self.q[BASE + 1 :]
        rates = reading.joint_velocities
        gains = self._joints[rates is not None][at]
        steps = gains[:, 0, None] * missed
        if rates is not None:
            steps += gains[:, 1, None] * (rates - self.v[JOINTS])
        self.q[BASE + 1 :] += steps[0]
        self._take(JOINTS, steps)
        self._stand(self.q, self.v)

    def _take(self, which: slice, steps: FloatArray) -> None:
        self.v[which] += steps[1]
        self.error[which] += steps[2]

    def land(self) -> None:
        """The swing foot lands flat and becomes the stance foot, where it is."""
        landing = self._stance.other
        foothold = self.sole(landing)
        M = pin.crba(self._model, self._data, self.q, pin.Convention.WORLD)
        pin.updateFramePlacements(self._model, self._data)
        J = pin.getFrameJacobian(self._model, self._data, self.free.sole_frame(landing), pin.LOCAL_WORLD_ALIGNED)
        reaction = cho_solve(cho_factor(M), J.T)
        self.v = self.v - reaction @ np.linalg.solve(J @ reaction, J @ self.v)
        self._remembered[self._stance] = self.error
        self._stance = landing
        self.error = self._remembered[landing].copy()
        self._readings = 0
        self.foothold = foothold * (1.0, 1.0, 0.0)
        self._stand(self.q, self.v)

    @property
    def place(self) -> tuple[float, float]:
        """x and y of the stance sole in the world by the present estimate [m]."""
        return float(self.foothold[0]), float(self.foothold[1])

    def stand_on(self, side: Stance) -> None:
        """Of two feet that stand, take this one for the stance foot, where it is."""
        if side is self._stance:
            return
        foothold = self.sole(side)
        self._remembered[self._stance] = self.error
        self._stance, self.foothold = side, foothold * (1.0, 1.0, 0.0)
        self._stand(self.q, self.v)

    def ahead(self, accelerations: Iterable[FloatArray]) -> tuple[FloatArray, FloatArray]:
        """q (nq,) and v (nv,) after accelerations that are on their way, each for a period."""
        q, v = self.q, self.v
        moved = False
        for dv in accelerations:
            q, v = self._advanced(q, v, dv)
            moved = True
        if moved:
            self._stand(q, v)
        return q, v

    def sole(self, side: Stance) -> FloatArray:
        """(3,) where a sole is in the world by the present estimate [m]."""
        pin.forwardKinematics(self._model, self._data, self.q, self.v)
        return pin.updateFramePlacement(self._model, self._data, self.free.sole_frame(side)).translation.copy()

    def clearance(self, side: Stance) -> float:
        """Height of the lowest corner of a foot's sole above the stance sole [m], right after `correct`."""
        placement = pin.updateFramePlacement(self._model, self._data, self.free.sole_frame(side))
        # `_stand` has moved the base since the kinematics were computed
        lifted = self.q[2] - self._data.oMi[1].translation[2]
        return float(placement.translation[2] + lifted + (self._corners[side] @ placement.rotation[2]).min())

    def _advanced(self, q: FloatArray, v: FloatArray, dv: FloatArray) -> tuple[FloatArray, FloatArray]:
        h = self.period
        gained = h * (dv + self.error)
        return pin.integrate(self._model, q, h * (v + 0.5 * gained)), v + gained

    def _stand(self, q: FloatArray, v: FloatArray) -> None:
        """Base position and velocity from the stance foot's."""
        model, data, frame = self._model, self._data, self.free.sole_frame(self._stance)
        pin.forwardKinematics(model, data, q, v)
        placement = pin.updateFramePlacement(model, data, frame)
        velocity = pin.getFrameVelocity(model, data, frame, pin.LOCAL_WORLD_ALIGNED).linear
        q[:3] += self.foothold - placement.translation
        v[:3] -= data.oMi[1].rotation.T @ velocity


def exact(settings: SpatialEstimatorSettings) -> SpatialEstimatorSettings:
    """For readings without noise: the same, all but taken as they come."""
    tiny = {"encoder_noise": 1e-6, "velocity_noise": 1e-5, "blind": 0.0}
    return SpatialEstimatorSettings(replace(settings.joints, **tiny), replace(settings.pelvis, **tiny))
