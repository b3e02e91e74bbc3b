"""Where a walk in space starts, as a state of the free robot: right after an impact of a planar gait, or at rest."""

import numpy as np

from frontal_biped.arrays import FloatArray
from frontal_biped.control.landing_widths import standing_pose
from frontal_biped.exceptions import SimulationError, UnreachablePoseError
from frontal_biped.gait.gait import Gait
from frontal_biped.model.biped import FrontalBiped
from frontal_biped.model.space.free_robot import FreeRobot
from frontal_biped.model.space.planar_state import PlanarStates
from frontal_biped.model.space.virtual_legs import SpaceState
from frontal_biped.model.stance_map import Stance
from frontal_biped.model.state import State
from frontal_biped.simulation.engine import first_foothold
from frontal_biped.simulation.space.engine import SpatialState

AT_THE_END = 1e-6
"""How far beyond the end of its range a joint counts as at it [rad]: some URDFs round both."""


def start_in_space(
    free: FreeRobot, biped: FrontalBiped, state: State, stance: Stance = Stance.LEFT, state_in: SpaceState | None = None
) -> SpatialState:
    """The state in space of a state in the plane.

    As `planar_state` says, the stance foot where the feet are level about y = 0.

    Args:
        free: the robot.
        biped: the same in the plane.
        state: in stance coordinates, for example `Gait.state_after_impact`.
        stance: the foot it stands on.
        state_in: work space for the robot; None: a new one.

    Raises:
        SimulationError: the legs do not reach there.
    """
    states = PlanarStates(free, state_in)
    foothold = np.array([0.0, first_foothold(biped, stance, state.q), 0.0])
    try:
        q, v = states.state(state, stance, foothold, free.posture)
    except UnreachablePoseError as error:
        raise SimulationError(
            f"{free.name}: its legs do not reach the start of the gait, {error}; bend the knees in the [posture] of its"
            " description, or give virtual_legs = true"
        ) from None
    _check_ranges(free, q)
    return SpatialState(q, v)


def standing_in_space(free: FreeRobot, biped: FrontalBiped, gait: Gait, stance: Stance = Stance.LEFT) -> SpatialState:
    """At rest on both feet, as far apart as the gait lands, the centre of mass midway.

    Args:
        free: the robot.
        biped: the same in the plane.
        gait: whose width it is.
        stance: the foot that is seen as the stance foot.

    Raises:
        SimulationError: the legs do not reach there.
    """
    pose = standing_pose(biped, gait)
    if pose is None:
        raise SimulationError(
            f"{free.name}: no pose puts both feet as far apart as this gait lands and the centre of mass midway; design"
            " one of another step width"
        )
    return start_in_space(free, biped, State(pose, np.zeros(4)), stance)


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
