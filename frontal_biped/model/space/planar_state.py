"""A state in the frontal plane as a state of the free robot: what the plane leaves open is as at the posture.

The stance foot lies flat and at rest, the swing foot beside it; the virtual legs have the angles of the planar state
and the lengths of the posture; the pelvis does not pitch or yaw and is as far ahead of the feet as at the posture,
where every joint outside the legs stays. These are eighteen equations for six freedoms of the base and six of each leg.
"""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import UnreachablePoseError
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState, X
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State

ACCURACY = 1e-12
"""Largest error of what such a state must satisfy [m, rad]."""

MOST_ITERATIONS = 50


class PlanarStates:
    """Carries planar states over into space.

    Args:
        free: the robot.
        space: work space for it; None: a new one.
    """

    def __init__(self, free: FreeRobot, space: SpaceState | None = None) -> None:
        self._space = space or SpaceState(free)
        self._still = np.zeros(free.model.nv)
        self._columns = [*range(BASE), *(BASE + joint for side in Stance for joint in free.leg(side))]

    def state(
        self, frontal: State, stance: Stance, foothold: FloatArray, near: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Configuration (nq,) and velocity (nv,) of the free robot.

        Args:
            frontal: state in stance coordinates.
            stance: the foot it stands on.
            foothold: (3,) where the origin of that foot's sole is [m].
            near: (nq,) where to search from: the posture, or the answer of an instant before.

        Raises:
            UnreachablePoseError: the legs do not reach there; the message says how much is missing.
        """
        model, space, q = self._space.free.model, self._space, near
        for _ in range(MOST_ITERATIONS):
            error, J, _ = _wanted(space.at(q, self._still), stance, frontal.q, foothold)
            if np.max(np.abs(error)) < ACCURACY:
                return q, self._solved(J, frontal.dq, np.zeros(len(J)))
            step = np.zeros(model.nv)
            step[self._columns] = -np.linalg.lstsq(J[:, self._columns], error)[0]
            q = pin.integrate(model, q, step)
        raise UnreachablePoseError(f"{np.max(np.abs(error)):.1e} is missing (m or rad)")

    def acceleration(self, q: FloatArray, v: FloatArray, frontal: FloatArray, stance: Stance) -> FloatArray:
        """(nv,) acceleration of the free robot.

        Args:
            q: (nq,) configuration, as `state` answers.
            v: (nv,) velocity, likewise.
            frontal: (4,) accelerations of the stance coordinates [rad/s^2].
            stance: the foot it stands on.
        """
        _, J, drift = _wanted(self._space.at(q, v), stance, np.zeros(4), np.zeros(3))
        return self._solved(J, frontal, drift)

    def _solved(self, J: FloatArray, frontal: FloatArray, drift: FloatArray) -> FloatArray:
        rates = -drift
        rates[:4] += frontal
        solution = np.zeros(J.shape[1])
        solution[self._columns] = np.linalg.lstsq(J[:, self._columns], rates)[0]
        return solution


def _wanted(
    space: SpaceState, stance: Stance, frontal: FloatArray, foothold: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Errors (18,) of a state from the one wanted, the four of the plane first; their Jacobian and drift.

    Errors in m and rad; the drift is their acceleration where the robot does not accelerate.
    """
    seen, stands, swings = space.frontal(stance), space.feet[stance], space.feet[stance.other]
    legs = [space.legs[side] for side in Stance]
    ahead = np.zeros((1, space.free.model.nv))  # of the root over the stance foot
    rotation = pin.Quaternion(space.q[3:7]).matrix()
    ahead[0, :3] = rotation[X]
    turning = [float(rotation[X] @ (pin.skew(space.v[3:BASE]) @ space.v[:3]))]
    posture = space.free.posture[X]
    error = np.concatenate(
        [
            seen.q - frontal,
            [leg.values[LENGTH] - space.lengths[side] for side, leg in zip(Stance, legs, strict=True)],
            space.pelvis.angles[[PITCH, YAW]],
            stands.position - foothold,
            stands.turning.angles,
            [swings.position[X] - foothold[X]],
            swings.turning.angles[[PITCH, YAW]],
            [space.q[X] - foothold[X] - posture],
        ]
    )
    J = np.vstack(
        [
            seen.J,
            *(leg.J[[LENGTH]] for leg in legs),
            space.pelvis.J[[PITCH, YAW]],
            stands.J[:3],
            stands.turning.J,
            swings.J[[X]],
            swings.turning.J[[PITCH, YAW]],
            ahead,
        ]
    )
    drift = np.concatenate(
        [
            seen.drift,
            *(leg.drift[[LENGTH]] for leg in legs),
            space.pelvis.drift[[PITCH, YAW]],
            stands.drift[:3],
            stands.turning.drift,
            swings.drift[[X]],
            swings.turning.drift[[PITCH, YAW]],
            turning,
        ]
    )
    return error, J, drift
