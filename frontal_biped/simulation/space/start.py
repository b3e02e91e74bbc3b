"""Where a walk in space starts: right after an impact of a planar gait, as a state of the free robot."""

import numpy as np
import pinocchio as pin

from frontal_biped.arrays import FloatArray
from frontal_biped.exceptions import SimulationError
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import BASE, FreeRobot
from frontal_biped.model.space.virtual_legs import LENGTH, PITCH, YAW, SpaceState, X
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import first_foothold
from frontal_biped.simulation.space.engine import SpatialState

ACCURACY = 1e-12
"""Largest error of what the start must satisfy [m, rad]."""

AT_THE_END = 1e-6
"""How far beyond the end of its range a joint counts as at it [rad]: some URDFs round both."""

MOST_ITERATIONS = 50


def start_in_space(
    free: FreeRobot, biped: FrontalBiped, state: State, stance: Stance = Stance.LEFT, state_in: SpaceState | None = None
) -> SpatialState:
    """The state in space of a state in the plane.

    The stance foot lies flat and at rest where the feet are level about y = 0, the swing foot beside it; the virtual
    legs have the angles of the planar state and the lengths of the posture; the pelvis does not pitch or yaw and is as
    far ahead of the feet as at the posture, where every joint outside the legs stays.

    Args:
        free: the robot.
        biped: the same in the plane.
        state: in stance coordinates, for example `Gait.state_after_impact`.
        stance: the foot it stands on.
        state_in: work space for the robot; None: a new one.

    Raises:
        SimulationError: the legs do not reach there.
    """
    space = state_in or SpaceState(free)
    model, q, still = free.model, free.posture.copy(), np.zeros(free.model.nv)
    columns = [*range(BASE), *(BASE + joint for side in Stance for joint in free.leg(side))]
    foothold = np.array([0.0, first_foothold(biped, stance, state.q), 0.0])
    for _ in range(MOST_ITERATIONS):
        error, J = _wanted(space.at(q, still), stance, state.q, foothold)
        if np.max(np.abs(error)) < ACCURACY:
            break
        step = np.zeros(model.nv)
        step[columns] = -np.linalg.lstsq(J[:, columns], error)[0]
        q = pin.integrate(model, q, step)
    else:
        raise SimulationError(
            f"{free.name}: its legs do not reach the start of the gait, {np.max(np.abs(error)):.1e} is missing (m or"
            " rad); bend the knees in the [posture] of its description, or give virtual_legs = true"
        )
    _check_ranges(free, q)
    rates = np.zeros(len(error))
    rates[:4] = state.dq
    v = np.zeros(model.nv)
    v[columns] = np.linalg.lstsq(J[:, columns], rates)[0]
    return SpatialState(q, v)


def _check_ranges(free: FreeRobot, q: FloatArray) -> None:
    limits, joints = free.limits, q[7:]
    beyond = np.maximum(limits.lower - joints, joints - limits.upper)
    worst = int(np.argmax(beyond))
    if beyond[worst] > AT_THE_END:
        raise SimulationError(
            f"{free.name}: at the start of the gait joint {free.joint_names[worst]!r} would be at {joints[worst]:.3f}"
            f" rad, beyond its range of {limits.lower[worst]:.3f} to {limits.upper[worst]:.3f} rad; change the"
            " [posture] of its description, or design a gait of another step width"
        )


def _wanted(
    space: SpaceState, stance: Stance, frontal: FloatArray, foothold: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Errors (18,) of a posture from the one wanted [m, rad], the four of the plane first, and their Jacobian."""
    seen, stands, swings = space.frontal(stance), space.feet[stance], space.feet[stance.other]
    legs = [space.legs[side] for side in Stance]
    ahead = np.zeros((1, space.free.model.nv))  # of the root over the stance foot
    rotation = pin.Quaternion(space.q[3:7]).matrix()
    ahead[0, :3] = rotation[X]
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
    return error, J
